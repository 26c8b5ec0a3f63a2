-- luacheck: Lua as LuaJIT runs it, plus the engine's one global table.
std = "luajit"
max_line_length = 120
globals = { "corsac" }
exclude_files = { "build/**", "out/**" }
-- Callbacks declare all their arguments, so that a reader sees what is on offer.
unused_args = false
-- The API's own half remakes Lua's base library; the stubs are for editors only.
files["scripts/corsac"] = { std = "luajit", ignore = { "121", "122", "142", "143" } }
files["scripts/types"] = { ignore = { ".*" } }

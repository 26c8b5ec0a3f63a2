-- Runs last, when the bindings stand: what a window shows after an error.
local engine = ...
local gfx = corsac.gfx

function engine.errorScreen(text)
    gfx.rect(0, 0, 16384, 16384, { 0.09, 0.12, 0.2, 0.94 })
    gfx.print("An error stopped this callback", 40, 36, 28, { 1, 0.62, 0.35 })
    local y = 88
    for line in (text .. "\n"):gmatch("(.-)\n") do
        gfx.print(line, 40, y, 18, { 0.93, 0.93, 0.95 })
        y = y + 24
    end
    gfx.print("F5 reloads the scene, Escape ends the run", 40, y + 24, 18, { 0.6, 0.75, 1 })
end

-- Runs last, when the bindings stand: what a window shows after an error.
local engine = ...
local gfx = corsac.gfx
local WIDTH = 108 -- characters in a line of the error screen

function engine.errorScreen(text)
    gfx.rect(0, 0, 16384, 16384, { 0.09, 0.12, 0.2, 0.94 })
    gfx.print("An error stopped this callback", 40, 36, 28, { 1, 0.62, 0.35 })
    local y = 88
    for line in (text .. "\n"):gmatch("(.-)\n") do
        while line do
            local head, rest = line, nil
            if #line > WIDTH then
                head = line:sub(1, WIDTH):match("^(.*%s)%S*$") or line:sub(1, WIDTH)
                rest = "        " .. line:sub(#head + 1)
            end
            gfx.print(head, 40, y, 18, { 0.93, 0.93, 0.95 })
            y, line = y + 24, rest
        end
    end
    gfx.print("F5 reloads the scene, Escape ends the run", 40, y + 24, 18, { 0.6, 0.75, 1 })
end

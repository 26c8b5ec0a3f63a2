-- One day under a procedural sky: hour 6 is sunrise, 12 noon. The environment lights what the sun
-- does not reach.
local hour = corsac.param("hour", 16.5)
local gfx, scene = corsac.gfx, corsac.scene

function corsac.conf(t)
    t.steps = 2
    t.size = { 960, 540 }
end

local function blend(a, b, t)
    return { a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t, a[3] + (b[3] - a[3]) * t }
end

function corsac.load()
    local angle = (hour - 6) / 12 * math.pi
    local x, y = math.cos(angle), math.max(math.sin(angle), 0.03)
    local low = 1 - math.min(1, y * 2.2) -- how near the sun is to the horizon
    local light = blend({ 1, 0.96, 0.88 }, { 1, 0.5, 0.2 }, low)
    gfx.setEnvironment{
        sun = { x, y, -0.45 },
        zenith = blend({ 0.16, 0.32, 0.72 }, { 0.1, 0.13, 0.3 }, low),
        horizon = blend({ 0.75, 0.86, 1 }, { 1, 0.55, 0.3 }, low),
        ground = { 0.16, 0.15, 0.13 },
        glow = blend({ 1.5, 1.3, 1 }, { 4, 1.8, 0.6 }, low), glowExponent = 24,
    }
    gfx.newLight{ type = "directional", direction = { -x, -y, 0.45 }, color = light, intensity = 3.2 - 1.2 * low }
    scene.spawn{ mesh = "plane", scale = { 200, 1, 200 }, color = { 0.32, 0.34, 0.26 } }
    for i = 0, 30 do
        local a, r = i * 2.39996, 1.6 * math.sqrt(i + 1)
        local h = 0.8 + 2.6 * math.random()
        scene.spawn{ mesh = "cylinder", position = { r * math.cos(a), h / 2, r * math.sin(a) }, scale = { 0.8, h, 0.8 },
            material = gfx.newMaterial{ baseColor = { 0.75, 0.72, 0.66 }, roughness = 0.3 + 0.6 * math.random() } }
    end
    scene.spawn{ mesh = "sphere", position = { -1, 5.2, 1 }, scale = { 2.4, 2.4, 2.4 },
        material = gfx.newMaterial{ baseColor = { 0.95, 0.93, 0.9 }, metallic = 1, roughness = 0.08 } }
    gfx.setCamera{ position = { 5, 3.4, 17 }, target = { 0, 3, 0 }, fov = 0.85 }
end

-- args: --steps 240
-- Contacts call back: once when they begin, with speed and normal, once when they end; impacts sound.
local scene = corsac.scene
local begun, ended, loud, gone = 0, 0, 0, 0
local ball, floor, thud

function corsac.load()
  thud = corsac.audio.newSound("sounds/thud.wav")
  corsac.audio.setListener{ position = { 0, 1, 3 } }
  floor = scene.spawn{ position = { 0, -0.5, 0 },
    body = { type = "static", shape = "box", size = { 20, 1, 20 } } }
  ball = scene.spawn{ position = { 0, 5.5, 0 }, body = { shape = "sphere", radius = 0.5, restitution = 0.5,
    onContact = function(self, other, speed, nx, ny, nz)
      begun = begun + 1
      if begun == 1 then
        -- 5 m of fall: 9.9 m/s; the normal points from the ball to the floor.
        corsac.metrics.set("speed", speed)
        corsac.metrics.set("ny", ny)
        corsac.metrics.set("who", self == ball:getBody() and other == floor:getBody() and 1 or 0)
      end
      if speed > 0.5 then
        loud = loud + 1
        local x, y, z = self:getPosition()
        corsac.audio.newSource{ sound = thud, position = { x, y, z }, gain = math.min(speed / 10, 1) }
      end
    end,
    onContactEnd = function() ended = ended + 1 end } }
  -- One that is destroyed at its first touch hears no end of it.
  scene.spawn{ position = { 5, 2, 0 }, body = { shape = "sphere", radius = 0.5,
    onContact = function(self)
      gone = gone + 1
      self:getEntity():destroy()
    end,
    onContactEnd = function() gone = gone + 10 end } }
end

function corsac.fixed()
  corsac.metrics.set("begun", begun)
  corsac.metrics.set("ended", ended)
  corsac.metrics.set("loud", loud)
  corsac.metrics.set("gone", gone)
end

local expect = corsac.expect
expect("user.speed", ">=", 9.6)
expect("user.speed", "<=", 10.1)
expect("user.ny", "<=", -0.999)
expect("user.who", "==", 1)
expect("user.begun", ">=", 3)
expect("user.ended", ">=", 2)
expect("user.loud", ">=", 3)
expect("user.gone", "==", 1)
expect("counts.entities", "==", 2)

-- The shortest night in Foxlight: twice the fireflies, and everything is a little lighter.
corsac.mod.patch("garden", { fireflies = 440, gravity = 7 })

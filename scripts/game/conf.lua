function corsac.conf(t)
  t.title = "Foxlight"
  t.steps = 7200
  t.size = { 1280, 720 }
  t.actions = {
    walk_x = "-a,-left,d,right,pad_leftx",
    walk_z = "-w,-up,s,down,pad_lefty",
    look = "-q,e,pad_rightx",
    slow = "lshift,pad_lb",
    jump = "space,pad_a",
    spirit = "f,mouse2,pad_x",
    start = "enter,space,mouse1,pad_start,pad_a",
    pause = "escape,p,pad_start",
    quit = "backspace,pad_back",
  }
  t.gfx = { shadows = "pcf", shadow_distance = 30, bloom = 0.08, fxaa = "on", exposure = 1.35,
    fog = 0.012, fog_falloff = 0.2, fog_base = 1, fog_color = "0.012,0.024,0.05" }
  t.audio = { occlusion = "on" }
end

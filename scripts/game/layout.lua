-- Where things stand: plain data in metres. The way leads north, towards -z: court, see-saw, terrace
-- with the moonstone and the veil, bridge, yard with guard and key, door, grove.
local pi = math.pi
local layout = { start = { 0, 0, 22.5 }, stone = { -4, 0.9, 6 }, veil = { 0, 0.9, 2.4 },
  key = { -8.6, 1.75, -22.6 }, door = { 0, 0.9, -25 }, heart = { 0, 0.9, -33 } }

-- Static boxes: position, size, and what is shown there ("wall", "hedge"), repeated along the longer side.
layout.boxes = {
  -- The ground of court, terrace, yard and grove.
  { position = { 0, -1.5, 17.5 }, size = { 20, 3, 15 } },
  { position = { 0, -1.05, 6 }, size = { 20, 3.9, 8 } },
  { position = { 0, -1.05, -25 }, size = { 24, 3.9, 36 } },
  -- Court and terrace.
  { position = { -9, 1.2, 13.7 }, size = { 0.5, 2.4, 22.6 }, show = "wall" },
  { position = { 9, 1.2, 13.7 }, size = { 0.5, 2.4, 22.6 }, show = "wall" },
  { position = { 0, 1.2, 25 }, size = { 18, 2.4, 0.5 }, show = "wall" },
  { position = { -5.25, 2.1, 2.4 }, size = { 7.5, 2.4, 0.5 }, show = "wall" },
  { position = { 5.25, 2.1, 2.4 }, size = { 7.5, 2.4, 0.5 }, show = "wall" },
  -- Yard.
  { position = { -11, 2.1, -16 }, size = { 0.5, 2.4, 18 }, show = "wall" },
  { position = { 11, 2.1, -16 }, size = { 0.5, 2.4, 18 }, show = "wall" },
  { position = { -6.2, 1.6, -7.2 }, size = { 9.4, 1.4, 0.8 }, show = "hedge" },
  { position = { 6.2, 1.6, -7.2 }, size = { 9.4, 1.4, 0.8 }, show = "hedge" },
  { position = { -6.35, 2.1, -25 }, size = { 9.3, 2.4, 0.5 }, show = "wall" },
  { position = { 6.35, 2.1, -25 }, size = { 9.3, 2.4, 0.5 }, show = "wall" },
  { position = { -5, 1.5, -12.6 }, size = { 0.8, 1.2, 5 }, show = "hedge" },
  { position = { 5, 1.5, -12.6 }, size = { 0.8, 1.2, 5 }, show = "hedge" },
  { position = { 0, 1.5, -13 }, size = { 5, 1.2, 0.8 }, show = "hedge" },
  { position = { -5.8, 1.5, -19.6 }, size = { 6, 1.2, 0.8 }, show = "hedge" },
  { position = { 5.8, 1.5, -19.6 }, size = { 6, 1.2, 0.8 }, show = "hedge" },
  { position = { 8.2, 1.5, -16 }, size = { 3, 1.2, 0.8 }, show = "hedge" },
  -- Grove.
  { position = { -9, 2.1, -33.5 }, size = { 0.5, 2.4, 17 }, show = "wall" },
  { position = { 9, 2.1, -33.5 }, size = { 0.5, 2.4, 17 }, show = "wall" },
  { position = { 0, 2.1, -42 }, size = { 18, 2.4, 0.5 }, show = "wall" },
  -- Things that stand on the ground.
  { position = { -4, 1.6, 6 }, size = { 0.7, 1.5, 0.7 } },
  { position = { -8.6, 1.2, -22.6 }, size = { 0.6, 0.6, 0.6 } },
  { position = { 0, 1.5, -33 }, size = { 2.2, 1.2, 2.2 } },
}

-- Posts with a lantern that wakes when the fox comes near: x, y, z, turn.
layout.posts = {
  { -2.2, 0, 20.5, 0 }, { 2.4, 0, 17.8, pi }, { -2.8, 0, 15.2, 0 }, { 6.4, 0, 13, pi }, { -6.6, 0, 18, 0 },
  { 6.8, 0, 22, pi },
  { -5.6, 0, 11.6, 0.4 }, { 3.6, 0.9, 7.6, pi }, { -6.6, 0.9, 8.2, 0 }, { 6.4, 0.9, 4.4, pi },
  { -2, 0.9, 3.6, 0 },
  { 2, 0.9, -8.6, pi }, { -2.6, 0.9, -10.6, 0 }, { -8.8, 0.9, -9.4, 0 }, { 8.8, 0.9, -9.6, pi },
  { -8.8, 0.9, -16, 0 },
  { 2.4, 0.9, -17.2, pi }, { 8.8, 0.9, -22.4, pi }, { -5.4, 0.9, -22, 0 }, { 2.4, 0.9, -23, pi },
  { -2.4, 0.9, -28, 0 }, { 3.6, 0.9, -29.6, pi }, { -4.8, 0.9, -33, 0 }, { 4.8, 0.9, -35.6, pi },
}

-- Lanterns that swing on a cord: where the cord is tied, its length.
layout.swings = {
  { 3.6, 3.0, 19.6, 0.9 }, { -5.2, 3.0, 16.4, 1.0 }, { 0, 3.25, 2.4, 0.7 }, { 0, 3.25, -7.2, 0.7 },
  { -1.6, 2.4, -1, 0.6 },
  { 1.6, 2.4, -3.6, 0.6 }, { -6.8, 3.6, -29, 1.1 }, { 6.6, 3.6, -31, 1.2 }, { -5.8, 3.6, -37.4, 1.0 },
  { 5.6, 3.6, -38.6, 1.2 },
  { -2.2, 3.7, -36, 1.3 }, { 2.6, 3.7, -30.4, 1.3 },
}

-- Trees and other things without a body: model, x, y, z, turn, scale.
layout.plants = {
  { "tree", 4.4, 0, 19.4, 2.6, 1 }, { "tree", -6, 0, 16.2, 0.2, 1.05 }, { "tree", 7, 0, 15.6, 1, 0.9 },
  { "tree", -6.6, 0, 22.6, 2, 1.1 },
  { "tree", 7, 0.9, 7, 4, 1 }, { "tree", -7.6, 0.9, 4.2, 1, 0.9 }, { "tree", -7.6, 0.9, -29.2, 0.3, 1.25 },
  { "tree", 7.4, 0.9, -31.2, 3, 1.3 }, { "tree", -6.6, 0.9, -37.6, 0.5, 1.25 },
  { "tree", 6.4, 0.9, -39, 2.7, 1.3 },
  { "tree", -3, 0.9, -36.4, 0.4, 1.3 }, { "tree", 3.4, 0.9, -40.6, 5, 1.2 }, { "tree", 9.4, 0.9, -18, 1, 0.9 },
  { "rock", 5.4, 0, 11.2, 0.5, 1.4 }, { "rock", 4.6, 0, 10.7, 1.5, 0.8 }, { "rock", -7.8, 0, 11, 2.5, 1.6 },
  { "rock", -1.8, -1.5, -0.4, 2.5, 2.2 },
  { "rock", 2.6, -1.5, -3.5, 1, 2.6 }, { "rock", -3.4, -1.5, -5.4, 4, 2 }, { "rock", 5.8, -1.5, -1.2, 4, 2.4 },
  { "bush", 2.2, 0, 24, 0, 1 }, { "bush", -3.2, 0, 24.1, 1, 1.2 }, { "bush", 8.1, 0, 19, 2, 1.2 },
  { "bush", -8.2, 0, 14.4, 3, 1.1 },
  { "bush", 7.9, 0.9, 9, 2, 1 }, { "bush", -8, 0.9, 9, 3, 1 }, { "bush", 8.2, 0.9, -36, 3, 1.2 },
  { "bush", -8.1, 0.9, -34, 5, 1.2 },
  { "bush", 0.9, 0.9, -41, 1, 1.3 }, { "bush", -10.2, 0.9, -12.4, 1, 1 }, { "bush", 10.2, 0.9, -24, 1, 1.1 },
  { "reed", -4.6, -1.5, 0.8, 0, 1.2 }, { "reed", 4.2, -1.5, 0.6, 2, 1.1 }, { "reed", -6, -1.5, -5.8, 3, 1.3 },
  { "reed", 3.2, -1.5, -6, 1, 1.1 },
  { "reed", 7.6, -1.5, -5.6, 1, 1.3 }, { "reed", -8, -1.5, 0.6, 1, 1.3 },
  { "moonstone", -4, 0.9, 6, 0, 1 }, { "arch", 0, 0.9, 2.4, 0, 1 }, { "arch", 0, 0.9, -7.2, 0, 1 },
  { "arch", 0, 0.9, -25, 0, 1 },
  { "heart", 0, 0.9, -33, 0, 1 }, { "rock", -8.6, 0.9, -22.6, 0, 0.95 },
}

layout.patrol = { { -8, 0.9, -10 }, { 2, 0.9, -10 }, { 8, 0.9, -10.5 }, { 7.6, 0.9, -14 }, { 3, 0.9, -16.6 },
  { -3, 0.9, -17 }, { -8.4, 0.9, -17 } }

-- Where the fox comes to again: reached at a distance of 2 m.
layout.checkpoints = { layout.start, { 2, 0.9, 8.6 }, { 0, 0.9, 3.6 }, { 0, 0.9, -8.6 }, { 0, 0.9, -26.6 } }

return layout

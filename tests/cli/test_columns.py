"""corsac.phys.columns(): the same numbers as the methods, touch, and the checked mode's errors."""

import unittest

from support import SceneCase

SCENE = """
local phys = corsac.phys
local floor, ball
function corsac.load()
    phys.setGravity(0, 0, 0)
    floor = phys.newBody{ type = "static", shape = "box", position = { 0, -9, 0 } }
    for i = 1, 5 do ball = phys.newBody{ shape = "sphere", position = { 2 * i, 0, 0 } } end
end
function corsac.fixed()
    local c = phys.columns{ checked = corsac.getStep() == 2 }
    local row = c.row(ball)
    assert(c.n == 6 and c.handle(row) == ball)
    local x, y, z = ball:getPosition()
    assert(c.px[row] == x and c.py[row] == y and c.pz[row] == z)
    c.vx[row] = 3
    c.touch(row)
    assert(ball:getVelocity() == 3)
    TRY
end
"""


class Columns(SceneCase):
    def attempt(self, line, *texts, code=1):
        done = self.run_scene(SCENE.replace("TRY", line), "--steps", 4)
        self.assert_exit(done, code, *texts)

    def test_columns_agree_with_the_methods(self):
        self.attempt("", code=0)

    def test_a_row_out_of_range_is_found_in_checked_mode(self):
        self.attempt("if corsac.getStep() == 2 then local x = c.px[6] end",
                     "columns: px[6]: rows are whole numbers from 0 to 5", "scene.lua")

    def test_positions_are_read_only_in_checked_mode(self):
        self.attempt("if corsac.getStep() == 2 then c.px[1] = 0 end", "px is read-only")

    def test_an_old_view_is_found_in_checked_mode(self):
        self.attempt("if corsac.getStep() == 2 then OLD = c end "
                     "if corsac.getStep() == 3 then local x = OLD.px[0] end", "earlier callback")

    def test_touch_refuses_static_bodies_and_bad_numbers(self):
        self.attempt("c.touch(c.row(floor))", "touch(0): the row must be a moving body's")
        self.attempt("c.vx[row] = 0/0 c.touch(row)", "its velocities finite")

    def test_row_wants_a_body(self):
        self.attempt("c.row(7)", "row(body) expects a Body, got the number 7")


if __name__ == "__main__":
    unittest.main()

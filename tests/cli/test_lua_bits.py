"""Lua computes the same bits in every process, on every processor, compiled or interpreted."""

import unittest

from support import SceneCase

# Every operator and math function in loops hot enough to be compiled, over plain and odd values;
# the order of pairs and next; random numbers; texts of values. All of it ends in one 64-bit sum,
# printed, and in the positions of entities, hence in the hash.
BITS = r"""
if corsac.param("interpreter", false) then jit.off() end
local ffi = require("ffi")
local sum = 14695981039346656037ULL
local word = ffi.new("union { double d; uint64_t u; }")
local function eat(x)
    if x ~= x then x = 0.5 end -- the sign of a NaN is not defined
    word.d = x
    sum = bit.bxor(sum, word.u) * 1099511628211ULL
end
local function eatText(s) for i = 1, #s do eat(s:byte(i)) end end

local values = { 0, -0.0, 1, -1, 2, 3, 0.1, -0.1, 0.5, 1.5, 7, 10, 1e-3, 123.456, -98.7, 1e10, 2^31, 2^53, 1e-310, 1e300, math.pi, 1/3 }
local unary = { "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "log10", "sqrt", "sinh", "cosh", "tanh", "floor", "ceil", "abs", "deg", "rad" }
local binary = { "atan2", "fmod", "max", "min" }

local function hot()
    for _, name in ipairs(unary) do
        local f = math[name]
        for round = 1, 8 do
            for i = 1, #values do eat(f(values[i] * round)) end
        end
    end
    for _, name in ipairs(binary) do
        local f = math[name]
        for i = 1, #values do
            for j = 1, #values do eat(f(values[i], values[j])) end
        end
    end
    for i = 1, #values do
        local a = values[i]
        for j = 1, #values do
            local b = values[j]
            eat(a + b) eat(a - b) eat(a * b) eat(a / b) eat(a % b) eat(a ^ b) eat(-a) eat(math.pow(a, b))
        end
        eat(a ^ 2) eat(a ^ 3) eat(a ^ 0.5) eat(a ^ -1) eat(a ^ -2) eat(a ^ 4) eat(2 ^ a) eat(10 ^ a) eat(a ^ 1) eat(a ^ 0) eat(a ^ 17) eat(a ^ -0.5)
        eat(math.log(math.abs(a) + 0.25, 10)) eat(math.log(math.abs(a) + 0.25, 2)) eat(math.log(math.abs(a) + 1, 7))
        local m, e = math.frexp(a) eat(m) eat(e) eat(math.ldexp(a, 3))
        local w, p = math.modf(a) eat(w) eat(p)
        eatText(tostring(a)) eatText(string.format("%.14g %.3f %e %5d", a, a, a, i)) eat(tonumber(tostring(a)))
    end
    local x = 0.3
    for i = 1, 2000 do x = math.sin(x * 1.7) ^ 2 + math.exp(-x) * math.log(1 + x * x) eat(x) end
    for i = 1, 300 do eat(math.random()) eat(math.random(i)) eat(math.random(-i, i)) end
end

local bodies = {}
local function objects() -- methods and columns between one another: every value is what it was when read
    for i = 1, #bodies do
        local a, b = bodies[i], bodies[i % #bodies + 1]
        local x, y, z = a:getPosition()
        local u, v, w = b:getPosition()
        local p, q, r = a:getVelocity()
        a:setVelocity(p + 0.01 * (u - x), q + 0.01 * (v - y), r + 0.01 * (w - z))
        local s, t = a:getVelocity()
        eat(x) eat(u) eat(p) eat(s - p) eat(t - q) eat(x + u * p)
        local c = corsac.phys.columns()
        local row = c.row(b)
        local before = c.vx[row]
        b:setVelocity(before + 1, 0, 0)
        eat(before) eat(c.vx[row])
        c.vy[row] = before
        c.touch(row)
        eat(c.vy[row] + before)
    end
end

local function once() -- values used once, after another call: the compiler could load them too late
    for i = 1, #bodies do
        local b = bodies[i]
        local x, y, z = b:getPosition()
        local vx, vy, vz = b:getVelocity()
        b:setVelocity(vx, vy + 0.001 * (x + y + z), vz)
    end
    for i = 1, #bodies do eat((select(2, bodies[i]:getVelocity()))) end
end

local folded = { 2 ^ 0.5, 10 ^ -3, 3 ^ 7, 2 ^ 0.1, 0.1 ^ 0.1 } -- by the compiler of source text

function corsac.load()
    for i = 1, #folded do eat(folded[i]) end
    for round = 1, 4 do hot() end
    for i = 1, 150 do
        bodies[i] = corsac.phys.newBody{ shape = "sphere", position = { i * 2, i % 7, i % 3 }, velocity = { i, 0, -i } }
    end
    for round = 1, 5 do objects() once() end
    local t = {}
    for i = 1, 200 do t["key" .. (i * 7919) % 1009] = i t[i * 0.5] = i end
    for i = 1, 20 do t[corsac.scene.spawn{ position = { i, 0, 0 } }] = i end
    t[true], t[false] = 1, 2
    for k, v in pairs(t) do eat(v) eatText(tostring(k)) end
    local k, v = next(t)
    for _ = 1, 50 do eat(v) k, v = next(t, k) end
    eatText(tostring({}) .. tostring(print) .. tostring(coroutine.create(print)) .. string.format("%s", {}))
    local low, high = tonumber(bit.band(sum, 0xffffffULL)), tonumber(bit.rshift(sum, 40))
    corsac.scene.spawn{ position = { low / 16777216, high / 16777216, 0 }, body = { shape = "sphere" } }
    print("sum " .. tostring(sum))
end
"""


class Bits(SceneCase):
    def sums(self, *args, **options):
        done = self.run_scene(BITS, "--steps", 3, "--hash", *args, **options)
        self.assert_exit(done, 0, "sum ")
        line = next(line for line in done.err.splitlines() if "sum " in line)
        return line.split("sum ")[1], done.out.strip()

    def test_twenty_processes_give_one_hash(self):
        self.assertEqual(len({self.sums() for _ in range(20)}), 1)

    def test_the_interpreter_gives_the_same_bits_as_compiled_traces(self):
        self.assertEqual(self.sums(), self.sums("--set", "interpreter=true"))

    def test_the_c_library_of_the_processor_does_not_matter(self):
        masked = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX2_Usable,-FMA_Usable"}
        self.assertEqual(self.sums(), self.sums(env=masked))

    def test_threads_and_instruction_sets_do_not_matter(self):
        self.assertEqual(self.sums("--threads", 1), self.sums("--threads", 2, "--simd", "sse2"))

    def test_another_seed_gives_other_numbers(self):
        self.assertNotEqual(self.sums("--seed", 1), self.sums("--seed", 2))


if __name__ == "__main__":
    unittest.main()

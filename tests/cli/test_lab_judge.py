"""The lab's arithmetic: fronts, fitted orders, expectations, map sampling, bounds of tune."""

import math
import sys
import unittest
from types import SimpleNamespace

from support import ROOT

sys.path.insert(0, str(ROOT / "tools/lab"))

import experiment  # noqa: E402
import judge  # noqa: E402
import maps  # noqa: E402
import publish  # noqa: E402
import references  # noqa: E402
import tune  # noqa: E402


def row(method, error, cost, **point):
    def figure(v):
        return None if v is None else {"median": v, "lo": v, "hi": v}
    return {"method": method, "point": point, "error": figure(error), "cost": figure(cost), "figures": {}}


def problems(rows, **rule):
    exp = SimpleNamespace(expect=[rule])
    return [p for _, found in judge.check(exp, rows) for p in found]


class Judge(unittest.TestCase):
    def test_summary_leaves_out_what_is_no_number(self):
        self.assertEqual(judge.summary([3, None, 1, math.nan, 2]), {"median": 2, "lo": 1, "hi": 3})
        self.assertIsNone(judge.summary([None, math.inf, True]))

    def test_front_keeps_what_nothing_beats(self):
        rows = [row("a", 1.0, 1), row("a", 0.5, 3), row("b", 0.7, 2), row("b", 0.6, 4), row("b", None, 1)]
        self.assertEqual([(r["error"]["median"], r["cost"]["median"]) for r in judge.front(rows)],
                         [(1.0, 1), (0.7, 2), (0.5, 3)])

    def test_fitted_order(self):
        self.assertAlmostEqual(judge.fit_order([(h, 3 * h ** 4) for h in (0.1, 0.05, 0.02)]), 4, places=9)
        self.assertIsNone(judge.fit_order([(0.1, 0)]))

    def test_order_expectation(self):
        rows = [row("a", h ** 2, 1, dt=h) for h in (0.4, 0.2, 0.1)]
        rule = {"kind": "order", "method": "a", "over": "dt", "tolerance": 0.1}
        self.assertEqual(problems(rows, order=2, **rule), [])
        self.assertIn("order 2.00", problems(rows, order=1, **rule)[0])

    def test_bound_holds_only_for_numbers_within(self):
        rows = [row("a", 1e-3, 1), row("b", None, 1)]
        rule = {"kind": "bound", "key": "error", "op": "<=", "value": 1e-3}
        self.assertEqual(problems(rows, method="a", **rule), [])
        self.assertEqual(len(problems(rows, **rule)), 1)

    def test_equal_better_and_monotone(self):
        rows = [row("a", 4.0, 1, n=1), row("a", 2.0, 1, n=2), row("b", 4.0, 3, n=1), row("b", 9.0, 3, n=2)]
        self.assertEqual(len(problems(rows, kind="equal", key="error")), 1)
        self.assertEqual(problems(rows, kind="equal", key="error", methods=["a"]), [])
        self.assertEqual(problems(rows, kind="differ", key="error", method="a", to="b"), [])
        self.assertEqual(len(problems(rows, kind="differ", key="error", method="a", to="b", where={"n": 1})), 1)
        self.assertEqual(problems(rows, kind="better", method="a", to="b", key="cost", factor=3), [])
        self.assertEqual(len(problems(rows, kind="better", method="a", to="b", key="cost", factor=4)), 2)
        self.assertEqual(problems(rows, kind="monotone", method="b", over="n"), [])
        self.assertEqual(len(problems(rows, kind="monotone", method="a", over="n")), 1)

    def test_never_loses(self):
        rows = [row("a", 1.0, 1), row("a", 0.1, 2), row("b", 1.0, 2), row("b", 0.01, 3)]
        rule = {"kind": "never_loses", "method": "a", "to": "b"}
        self.assertEqual(len(problems(rows, **rule)), 1)
        self.assertEqual(problems([*rows[:3]], **rule), [])

    def test_an_unknown_kind_and_a_missing_field_are_named(self):
        self.assertIn("unknown kind", problems([], kind="bonud")[0])
        self.assertIn("lacks the field", problems([row("a", 1, 1)], kind="bound")[0])

    def test_sentence_names_the_cheaper_at_a_shared_error(self):
        exp = SimpleNamespace(chart={}, error={"key": "e", "unit": "m", "label": "sag"}, cost={"key": "c", "unit": "ms"},
                              sweep={}, methods={})
        rows = [row("soft", 1e-3, 1), row("soft", 1e-4, 2), row("old", 1e-3, 6)]
        self.assertEqual(judge.sentence(exp, rows), "At 1 mm sag, soft costs 1 ms: 6 times less than old.")
        rows.append(row("worst", 9, 1))
        self.assertEqual(judge.sentence(exp, rows),
                         "At 1 mm sag, soft costs 1 ms: 6 times less than old (worst ends at 9 m).")


class Maps(unittest.TestCase):
    def test_samples_gather_along_the_border(self):
        axis = {"lo": 0, "hi": 1}
        exp = SimpleNamespace(map={"x": {**axis, "name": "x"}, "y": {**axis, "name": "y"}, "grid": 4, "depth": 3,
                                   "criteria": [{"name": "explodes", "key": "r", "op": ">", "value": 1}]})
        found = maps.sample(exp, "a", lambda label, at: [{"r": x * x + y * y} for x, y in at])
        for s in found:
            self.assertEqual(s["verdict"], "explodes" if s["x"] ** 2 + s["y"] ** 2 > 1 else "stable")
        near = sum(abs(math.hypot(s["x"], s["y"]) - 1) < 0.1 for s in found)
        self.assertLess(len(found), 33 * 33 / 2)
        self.assertGreater(near, len(found) / 2)

    def test_what_broke_or_is_not_finite_failed(self):
        exp = SimpleNamespace(map={"criteria": [{"name": "explodes", "key": "r", "op": ">", "value": 1}]})
        for figures in ({"broken": "exit 1"}, {}, {"r": math.nan}, {"r": None}, {"r": 2}):
            self.assertEqual(maps.verdict(exp, figures), "explodes", figures)
        self.assertEqual(maps.verdict(exp, {"r": 1}), "stable")


class Files(unittest.TestCase):
    def test_every_experiment_can_be_read_and_its_case_is_complete(self):
        files = sorted((ROOT / "scripts/lab").glob("*.toml"))
        self.assertGreater(len(files), 10)
        for path in files:
            exp = experiment.load(path)
            label = next(iter(exp.methods))
            exp.params(label, {name: values[0] for name, values in exp.sweep.items()}, 1)
            if exp.scene:
                self.assertTrue((ROOT / exp.scene).is_file(), exp.scene)
            if exp.reference:
                self.assertIn(exp.reference, references.JUDGES)

    def test_maps_are_stored_in_a_form_that_reads_back(self):
        import json
        result = {"experiment": "m", "methods": {"a": {"params": {}, "samples": [{"x": 1, "y": 2, "verdict": "stable"}]}}}
        self.assertEqual(json.loads(publish.compact(result))["methods"]["a"]["samples"], [[1, 2, "stable"]])

    def test_the_digest_is_of_what_a_full_run_depends_on(self):
        raw = {"title": "t", "methods": {"a": {}}, "sweep": {"n": [1, 2]}, "quick": True}
        full = experiment.digest_of(raw)
        self.assertEqual(full, experiment.digest_of({**raw, "quick": False, "quick_sweep": {"n": [1]}}))
        self.assertNotEqual(full, experiment.digest_of({**raw, "sweep": {"n": [1, 3]}}))

    def test_candidates_of_tune_come_cheapest_first(self):
        def row(cost, **settings):
            return {"settings": settings, "error": 1, "cost": cost}
        fronts = {"contact_a": [row(2, s=1), row(6, s=4)], "contact_b": [row(10, s=1), row(50, s=4)],
                  "world_o": [row(1, **{"phys.integrator": "exact"}), row(1.5, **{"phys.integrator": "rk4"})]}
        self.assertEqual(tune.candidates(fronts), [
            (1, {"s": 1}), (1.5, {"s": 1, "phys.integrator": "rk4"}),
            (4, {"s": 4}), (6, {"s": 4, "phys.integrator": "rk4"})])

    def test_bounds_of_tune(self):
        bounds = [tune.read_bound("accuracy.nan == 0"), tune.read_bound("user.sag_mm<=2.5")]
        self.assertEqual(bounds, [("accuracy.nan", "==", 0), ("user.sag_mm", "<=", 2.5)])
        self.assertIsNone(tune.breach({"accuracy.nan": 0, "user.sag_mm": 2.5}, bounds))
        self.assertEqual(tune.breach({"accuracy.nan": 0, "user.sag_mm": 3}, bounds), "user.sag_mm = 3")
        self.assertIn("nearest: user.sag_mm", tune.check_names({"user.sag_mm": 1}, [("user.sag_m", "<=", 1)]))


if __name__ == "__main__":
    unittest.main()

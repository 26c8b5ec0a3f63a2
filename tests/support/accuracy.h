// Figures of proofs: compared with their bound, and printed as a line that tests/run.py collects in
// out/accuracy.json.
#ifndef SUPPORT_ACCURACY_H
#define SUPPORT_ACCURACY_H

// Fails the running test unless value <= bound. NaN fails. Name and unit: plain words, no quotes.
void accuracy_at_most(const char *name, double value, double bound, const char *unit);

#endif

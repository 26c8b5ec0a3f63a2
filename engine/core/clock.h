// Clocks. For measurement only: no decision of the simulation reads them.
#ifndef CORE_CLOCK_H
#define CORE_CLOCK_H

#include "core/base.h"

uint64_t core_clock_ns(void);     // monotonic wall clock
uint64_t core_clock_cpu_ns(void); // CPU time of this process, all threads
void core_clock_sleep_ns(uint64_t ns);
size_t core_peak_rss_kb(void);

#endif

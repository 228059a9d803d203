/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * Tells libFuzzer which code of ./readers.c an input reaches. GCC knows no other way than to call a function at each edge: here it counts
 * in an array that libFuzzer looks at beside its own (its "extra counters"). This file is compiled without coverage.
 */

#include <stdint.h>

#define COUNTERS 8192u /* more than there are edges */

__attribute__((section("__libfuzzer_extra_counters"))) static uint8_t counters[COUNTERS];

void differential_trace_pc(void)
{
    const uintptr_t place = (uintptr_t)__builtin_return_address(0);
    counters[(place ^ place >> 13) % COUNTERS]++;
}

/* GCC reports comparisons of floating-point numbers too, which no part of libFuzzer listens to. */
void __sanitizer_cov_trace_cmpf(float a, float b)
{
    (void)a;
    (void)b;
}

void __sanitizer_cov_trace_cmpd(double a, double b)
{
    (void)a;
    (void)b;
}

#pragma once

// The vectorised kernels are compiled for AVX-512, AVX2 with fused multiply-add, SSE4, NEON, and as plain code (four
// lanes) for any other machine. The best one that the machine has is chosen at run time. Include this before Highway.
#define HWY_DISABLED_TARGETS                                                                                           \
    (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_WASM | HWY_WASM_EMU256)

// Highway falls back to one lane for GCC < 12.3, because of a bug in 16-bit integer products (gcc.gnu.org/PR106322).
// These kernels compute in floats only, and need four lanes.
#define HWY_BROKEN_EMU128 0

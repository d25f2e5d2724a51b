#pragma once

#include <algorithm>
#include <cstdlib>

/// Whether tests make all their random cases: where FILASOFIA_ALL_CASES is set, as the long tests have it.
inline bool allCases() { return std::getenv("FILASOFIA_ALL_CASES") != nullptr; }

/// Random cases, or steps, that a test makes: a fifth of all, at least one. Tests with the tag [cases] are run once
/// more, with all of them, as long tests.
inline int cases(int all) { return allCases() ? all : std::max(1, all / 5); }

/// Threads that are more than most machines have cores. They take turns there, which the sanitizers make slow.
#ifdef FILASOFIA_FEWER_CASES
constexpr int kManyThreads = 3;
#else
constexpr int kManyThreads = 8;
#endif

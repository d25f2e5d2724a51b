#pragma once

/// Random cases, or steps, that a test makes: all of them, but a fifth in the sanitized build of scripts/test.sh
/// (preset asan). scripts/check.sh makes all of them under the sanitizers too.
constexpr int cases(int all)
{
#ifdef FILASOFIA_FEWER_CASES
    return all / 5;
#else
    return all;
#endif
}

/// Threads that are more than most machines have cores. They take turns there, which the sanitizers make slow.
#ifdef FILASOFIA_FEWER_CASES
constexpr int kManyThreads = 3;
#else
constexpr int kManyThreads = 8;
#endif

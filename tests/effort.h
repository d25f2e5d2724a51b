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

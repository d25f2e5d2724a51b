#include "filasofia/core/assert.h"

#include <cstdio>
#include <cstdlib>

namespace filasofia {

void assertionFailed(const char* condition, const char* file, int line) noexcept
{
    std::fprintf(stderr, "%s:%d: broken precondition, a bug in the calling code: %s\n", file, line, condition);
    std::abort();
}

} // namespace filasofia

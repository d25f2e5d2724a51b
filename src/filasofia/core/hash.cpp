#include "filasofia/core/hash.h"

#include <cinttypes>
#include <cstdio>

namespace filasofia {

std::string hexadecimal(std::uint64_t hash)
{
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016" PRIx64, hash);
    return digits;
}

} // namespace filasofia

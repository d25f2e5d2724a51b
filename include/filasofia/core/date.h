#pragma once

#include <string>

namespace filasofia {

/// The time on the wall, as "2026-11-20 18:05:31": sorts by time.
std::string dateNow();

} // namespace filasofia

#pragma once

#include <string>

namespace filasofia {

/// The local date and time, as "2026-11-20 18:05:31", which sorts by time.
std::string dateNow();

} // namespace filasofia

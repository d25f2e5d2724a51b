#pragma once

#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/contact_cell.h"

namespace filasofia::app {

/// The project's limits for the cost of contacts. What was not measured is not judged.
std::vector<Verdict> judgeContact(const std::vector<ContactCell>& cells);

} // namespace filasofia::app

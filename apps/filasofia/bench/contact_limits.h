#pragma once

#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/contact_cell.h"

namespace filasofia::app {

/// The project's limits for the cost of contacts. A limit stays undecided if its cells were not measured.
std::vector<Verdict> judgeContact(const std::vector<ContactCell>& cells);

} // namespace filasofia::app

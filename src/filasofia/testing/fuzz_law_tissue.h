#pragma once

#include "filasofia/physics/defs.h"
#include "filasofia/testing/fuzz_laws.h"
#include "filasofia/testing/fuzz_random.h"

namespace filasofia::testing {

/// A law of this alternative of the variant with random constants.
physics::ElasticLaw randomLaw(std::size_t alternative, FuzzRandom& random);

/// Random tissue of that law: by chance with fibres, relaxation, plastic flow, regions, a threshold of tearing. `size`
/// [m]: that of the body. Counts in the report what it contains.
physics::FemMaterial randomTissue(std::size_t alternative, double size, FuzzRandom& random, LawFuzzReport& report);

/// A random shell.
physics::ShellMaterial randomShell(double size, FuzzRandom& random);

} // namespace filasofia::testing

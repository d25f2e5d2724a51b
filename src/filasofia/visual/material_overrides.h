#pragma once

#include "filasofia/visual/material.h"
#include "filasofia/visual/material_package.h"

namespace filasofia::visual {

/// The pool's material `base` with a body's own values. `package` is that of a CustomMaterial, else null. Throws an
/// Error that begins with `object` and names the parameter: if the material has none of this name (with the nearest
/// name that it has), if the value is of another type, or if a parameter comes twice. Ranges and files are checked
/// later, as those of every material.
Material overridden(const Material& base, const std::vector<MaterialParameter>& overrides,
                    const MaterialPackage* package, const std::string& object);

} // namespace filasofia::visual

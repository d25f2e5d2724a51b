#include "filasofia/physics/check_mouth.h"

#include "filasofia/core/validate.h"
#include "filasofia/physics/check_field.h"

namespace filasofia::physics {

void check(const Mouth& mouth, std::size_t elements, const std::string& object)
{
    validate(mouth, object);
    checkElement(mouth.element, elements, object + ".element");
    if (mouth.forward == Vec3{}) fail(object, ".forward must have a length > 0, got 0 0 0");
}

} // namespace filasofia::physics

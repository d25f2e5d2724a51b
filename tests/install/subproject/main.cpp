#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/units.h"
#include "filasofia/math/pose.h"

// A user's program: logs one line through the library and checks one result.
int main()
{
    using namespace filasofia;
    const Vec3 end = Vec3{1.0, 0.0, 0.0} + Vec3{0.0, 2.0_cm, 0.0};
    logInfo("a project outside the tree uses Filasofia; y = ", end.y, " m");
    return end.y == 0.02 ? 0 : 1;
}

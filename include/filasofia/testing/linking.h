#pragma once

#include "filasofia/math/vec3.h"

#include <span>
#include <vector>

/// How lines in space wind around each other, computed from their points alone: it knows nothing of contacts.
namespace filasofia::testing {

/// The Gauss integral over two segments, times 4 pi, exact (Klenin and Langowski 2000, method 1a).
double gaussIntegral(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// [-] How often one closed polygon goes through another.
double linkingNumber(std::span<const Vec3> x, std::span<const Vec3> y);

/// [-] By how much a closed polygon winds around itself.
double writhe(std::span<const Vec3> x);

/// A polygon before and after a step, in which its points move along straight lines.
struct MovedLine {
    std::span<const Vec3> before, after; ///< as many points
    bool closed = false;                 ///< its last point is joined to its first
};

/// Counts passes of lines through lines.
class PassCounter {
public:
    /// How often the first line passed through the second during the step: the sum of signed crossings of their edges,
    /// so passing and coming back in one step is none. The same line twice: through itself.
    int count(const MovedLine& first, const MovedLine& second);

private:
    struct Box {
        Vec3 low, high;
    };
    struct Boxes {
        std::vector<Box> edges, groups;
    };
    static void bound(const MovedLine& line, Boxes& out);

    Boxes first_, second_;
};

} // namespace filasofia::testing

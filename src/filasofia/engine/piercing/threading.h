#pragma once

#include "filasofia/engine/piercing/line.h"

#include <vector>

namespace filasofia::engine {

/// A channel as it lies now: its lines, and where on them its points are.
struct Threading {
    Threading(const Scene& scene, const Channel& of);

    const Channel& channel;
    std::size_t body; ///< index of the tissue among the soft bodies
    const SoftBody& tissue;
    LineShapes lines;
    std::vector<double> places; ///< [m] per point, on the lines; empty if no line exists any more

    [[nodiscard]] const PunctureModel& law() const { return *tissue.model.puncture; }
    /// Whether a line runs through a point.
    [[nodiscard]] bool occupied(std::size_t k) const { return k < places.size() && lines.occupied(places[k]); }
    /// [m] The length of line that an occupied point stands for: up to the middle between it and its neighbours, and up
    /// to the tip or the tail if the line ends there. All together are what is in the tissue: if its channel was cut
    /// across and gapes, a point stands for no more than tissue stretches to.
    [[nodiscard]] double lengthAt(std::size_t k) const;
    [[nodiscard]] double length() const; ///< [m] what is in the tissue
    /// The needle in front; null if there is none, or no more.
    [[nodiscard]] const LineShape* needle() const;
    /// The same; null also if it came out, and does not cut on.
    [[nodiscard]] const LineShape* cutting() const;
};

/// The body whose line is at a place of a channel; none if none is left.
BodyId bodyAt(const Scene& scene, const Channel& channel, double place);

/// [m] The tip's spring takes up so much before it cuts: a radius.
inline double giveOf(const PunctureModel& law, const LineShape& needle)
{
    return law.cutting > 0.0 ? needle.radius() : 0.0;
}

} // namespace filasofia::engine

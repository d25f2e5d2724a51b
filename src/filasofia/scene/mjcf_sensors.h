#pragma once

#include "filasofia/scene/mjcf_bodies.h"

/// The sensors of a model of MuJoCo.
namespace filasofia::scene {

/// Reads <sensor>, when all bodies and actuators are known.
class MjcfSensors {
public:
    /// `bodyOf`: each tree's body; none if it is in no scene.
    MjcfSensors(MjcfSource& source, const MjcfBodies& bodies, std::span<const BodyId> bodyOf)
        : source_(source), reader_(source.reader), bodies_(bodies), bodyOf_(bodyOf)
    {
    }

    [[nodiscard]] std::vector<prefab::SensorDef> read();

private:
    using Joint = std::pair<std::size_t, std::size_t>; ///< the tree, and the joint's number there
    [[nodiscard]] std::optional<prefab::SensorKind> kindOf(const Element& sensor);
    [[nodiscard]] std::optional<prefab::SensorKind> ofJoint(const Joint& joint) const;
    [[nodiscard]] std::optional<prefab::SensorKind> ofFrame(const Element& sensor);
    [[nodiscard]] std::optional<prefab::SensorKind> ofTouch(const Element& sensor);
    /// The place that objtype and objname mean; nothing, and told, if it is a camera.
    [[nodiscard]] std::optional<MjcfPlace> placeOf(const Element& sensor);

    MjcfSource& source_;
    XmlReader& reader_;
    const MjcfBodies& bodies_;
    std::span<const BodyId> bodyOf_;
};

} // namespace filasofia::scene

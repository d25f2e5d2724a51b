#pragma once

#include "filasofia/record/json_shapes.h"
#include "filasofia/scene/mesh_shapes.h"
#include "filasofia/scene/scene_def.h"

#include <set>
#include <string>
#include <utility>

/// The shapes of values that Defs have, for the reader of scene files and their schema alike.
namespace filasofia::scene {

using record::kIsArray;
using record::kIsOptional;
using record::kIsVariant;
using record::kIsVector;
using record::typeName;

template <class T>
concept IsFile = std::is_same_v<T, std::variant<std::string, std::shared_ptr<const device::Motion>>>;
/// Makes of a mesh source; the name of a file is one without it.
template <class T> struct MeshShapes;
template <> struct MeshShapes<physics::SoftMeshSource> {
    using Shapes = SoftShape;
};
template <> struct MeshShapes<physics::TriangleMeshSource> { // also runtime::SurfaceSource
    using Shapes = SurfaceShape;
};
template <class T>
concept IsMesh = requires
{
    typename MeshShapes<T>::Shapes;
};

template <class T> constexpr bool kFlat = false;
template <> inline constexpr bool kFlat<TimedCommand> = true;
template <> inline constexpr bool kFlat<SceneCamera> = true;
template <> inline constexpr bool kFlat<SceneLight> = true;
template <> inline constexpr bool kFlat<SceneView> = true;
template <> inline constexpr bool kFlat<SceneFollow> = true;
template <> inline constexpr bool kFlat<SceneInstrument> = true;
template <> inline constexpr bool kFlat<SceneKnot> = true;
template <> inline constexpr bool kFlat<prefab::SensorDef> = true;
template <> inline constexpr bool kFlat<SceneBody> = true; ///< its first field's members stand beside its others

/// Objects that may also be written as a list of their numbers.
template <class T>
concept IsNumbers = std::is_same_v<T, Vec3> || std::is_same_v<T, Quat> || std::is_same_v<T, visual::Color>;

/// The names of a Def's fields.
template <HasFields T> std::vector<std::string> fieldNames()
{
    std::vector<std::string> names;
    forEachField<T>([&](const auto& each) {
        if (!each.name.empty()) names.emplace_back(each.name);
    });
    return names;
}

template <class T, class... Each>
concept IsAnyOf = (std::is_same_v<T, Each> || ...);

/// The members that an object of this type must have: their defaults would be wrong for nearly all.
template <class T> std::vector<std::string_view> required()
{
    if constexpr (IsAnyOf<T, KeyPose, KeyTrocar>)
        return {"pose"};
    else if constexpr (std::is_same_v<T, KeyCommand>)
        return {"command"};
    else if constexpr (std::is_same_v<T, SceneView>)
        return {"camera"};
    else if constexpr (std::is_same_v<T, TimedCommand>)
        return {"time", "type"};
    else if constexpr (IsAnyOf<T, physics::Attach, physics::AttachRigid, SceneFollow, Reached, Held, Parted, Pierced,
                               prefab::TrackedBody, prefab::PositionSensor, prefab::VelocitySensor,
                               prefab::ContactForceSensor, prefab::AttachmentForceSensor, prefab::JointSensor,
                               prefab::CavitySensor, prefab::DuctSensor, prefab::BloodSensor, prefab::HeatSensor,
                               prefab::ElectrodeSensor, prefab::EnergySensor>)
        return {"body"};
    else if constexpr (std::is_same_v<T, physics::JointMimic>)
        return {"joint"};
    else if constexpr (std::is_same_v<T, Touched>)
        return {"first", "second"};
    else if constexpr (std::is_same_v<T, SceneTaskStep>)
        return {"done"};
    else if constexpr (IsAnyOf<T, physics::Grasp, physics::ApplyClip>)
        return {"rigid", "target"};
    else if constexpr (IsAnyOf<T, physics::SetForces, physics::SetWrench, physics::SetPressure, physics::SetFibreStress,
                               physics::SetTissue, physics::SetCurvature, physics::SetCutting, physics::SetCavity,
                               physics::Release, physics::RemovePiece, physics::RemoveBody, Activate>)
        return {"id"};
    else if constexpr (std::is_same_v<T, physics::RodSection>)
        return {"curvature"};
    else if constexpr (std::is_same_v<T, physics::SetPose>)
        return {"id", "pose"};
    else if constexpr (std::is_same_v<T, physics::SetJoint>)
        return {"id", "command"};
    else if constexpr (std::is_same_v<T, physics::SetHaptic>)
        return {"id", "target"};
    else if constexpr (std::is_same_v<T, SetMaterial>)
        return {"id", "material"};
    else if constexpr (std::is_same_v<T, Treat>)
        return {"id", "treatment"};
    else if constexpr (IsAnyOf<T, surface::Injure, surface::Seal, surface::Suck, surface::Heat>)
        return {"place"};
    else if constexpr (std::is_same_v<T, surface::Extract>)
        return {"flow"};
    else if constexpr (IsAnyOf<T, surface::SmokeDef, surface::DistensionDef>)
        return {"room"};
    else if constexpr (std::is_same_v<T, surface::DuctDef>)
        return {"path"};
    else if constexpr (std::is_same_v<T, prefab::ClipApplierDef>)
        return {"targets"};
    else if constexpr (std::is_same_v<T, SceneKnot>)
        return {"thread"};
    else if constexpr (IsAnyOf<T, BoxShape, BlockShape>)
        return {"size"};
    else if constexpr (std::is_same_v<T, SphereShape>)
        return {"radius"};
    else if constexpr (std::is_same_v<T, BladderShape>)
        return {"halfAxes", "wall"};
    else if constexpr (std::is_same_v<T, EllipsoidShape>)
        return {"halfAxes"};
    else if constexpr (IsAnyOf<T, CapsuleShape, CylinderShape>)
        return {"radius", "length"};
    else if constexpr (std::is_same_v<T, RevolvedShape>)
        return {"corners"};
    else if constexpr (std::is_same_v<T, SheetShape>)
        return {"width", "depth"};
    else if constexpr (IsAnyOf<T, ScaledSurface, ScaledTetrahedra>)
        return {"file"};
    else
        return {};
}

/// Calls visit.template operator()<Def>() once for every Def that can be reached from T, after those it names.
template <class T> struct DefWalk {
    template <class Visit> static void run(std::set<std::string>& seen, Visit& visit)
    {
        if constexpr (IsMesh<T>)
            DefWalk<typename MeshShapes<T>::Shapes>::run(seen, visit);
        else if constexpr (kIsOptional<T> || kIsVector<T>)
            DefWalk<typename T::value_type>::run(seen, visit);
        else if constexpr (HasFields<T> && !IsNumbers<T>)
            if (seen.emplace(typeName<T>()).second) {
                forEachField<T>([&](const auto& each) {
                    using Value = std::remove_cvref_t<decltype(std::declval<T&>().*(each.member))>;
                    DefWalk<Value>::run(seen, visit);
                });
                visit.template operator()<T>();
            }
    }
};
template <class... Each>
requires(!IsMesh<std::variant<Each...>>) struct DefWalk<std::variant<Each...>> {
    template <class Visit> static void run(std::set<std::string>& seen, Visit& visit)
    {
        if constexpr (!IsFile<std::variant<Each...>>) (DefWalk<Each>::run(seen, visit), ...);
    }
};

} // namespace filasofia::scene

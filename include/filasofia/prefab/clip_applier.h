#pragma once

#include "filasofia/physics/clip_def.h"
#include "filasofia/prefab/articulated_instrument.h"

namespace filasofia::prefab {

/// The clips of an instrument, and what they are closed on.
struct ClipApplierDef {
    physics::ClipDef clip = {};
    int clips = 6;                    ///< [-], in [1, 100], in its magazine
    std::vector<BodyId> targets = {}; ///< at least one soft body: that with most nodes between the jaws is clipped
    Vec3 place = {0.0, 0.0, -9e-3};   ///< [m], middle of the clip in the jaws, from the pivot
    double closesAt = 0.4;            ///< [-], in (0, 1), opening of the closing jaws at which they close the clip
    visual::Material material = visual::MetalMaterial{};
    /// Called on the stepping thread when a clip is closed: on this body, or, if it is 0, on nothing. Not a field of
    /// files.
    std::function<void(BodyId)> onClip = {};
};
constexpr auto fields(const ClipApplierDef*)
{
    using T = ClipApplierDef;
    return describe("ClipApplierDef", field("clip", &T::clip, "how a clip holds"),
                    field("clips", &T::clips, "-", closed(1, 100), "number of clips"),
                    field("targets", &T::targets, "soft bodies that it clips"),
                    field("place", &T::place, "m", finite(), "middle of the clip in the jaws"),
                    field("closesAt", &T::closesAt, "-", open(0, 1), "opening at which the jaws close the clip"),
                    field("material", &T::material, "what clips look like"));
}

/// Makes an instrument a clip applier. A clip lies in its open jaws, legs along the shaft. When they close, the clip
/// is closed on the tissue between its legs and stays there: a rigid body that can be pulled off
/// (physics::ClipDef::friction). With the next opening the next clip is there. If no tissue is between the legs, the
/// clip falls out of the jaws.
///
/// Any thread may call. A reset of the simulation takes the clips off the tissue; call reload() after it.
class ClipApplier {
public:
    /// Adds the clips. Throws an Error if the Def is wrong. Construct it before a run; the instrument must outlive it.
    ClipApplier(runtime::Simulation& simulation, const ArticulatedInstrument& tool, const ClipApplierDef& def);
    /// The same for a rigid body without jaws: a clip lies ready at once, and close() alone closes it. `place` is from
    /// the body's first element.
    ClipApplier(runtime::Simulation& simulation, BodyId tool, const ClipApplierDef& def);
    ~ClipApplier();
    ClipApplier(const ClipApplier&) = delete;
    ClipApplier& operator=(const ClipApplier&) = delete;

    [[nodiscard]] int left() const;    ///< [-], clips in the magazine
    [[nodiscard]] int applied() const; ///< [-], clips that were closed on tissue
    [[nodiscard]] int missed() const;  ///< [-], clips that were closed on nothing
    /// [-], clips among those applied that are on no tissue any more: they slipped off, lost it, or were released
    [[nodiscard]] int slipped() const;
    void close(); ///< closes the next clip where the tool is, also if its jaws do not; none left: nothing
    [[nodiscard]] std::vector<BodyId> bodies() const; ///< the clips, in the order in which they are used
    void reload();                                    ///< puts all clips back into the magazine

private:
    void begin();

    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callback
};

} // namespace filasofia::prefab

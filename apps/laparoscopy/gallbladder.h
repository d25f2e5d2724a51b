#pragma once

#include <filasofia/filasofia.h>
#include <filasofia/scene/scene_file.h>

#include <array>
#include <memory>
#include <vector>

/// A gall bladder in its bed, seen from below: the liver behind it, duct and artery to the right. Lengths are metres.
namespace operation {

/// A tube of the patient, by the rings of its mesh.
struct PatientTube {
    filasofia::BodyId body = {};
    int around = 0, along = 0; ///< cells of its mesh
    /// [m], the middle of a ring, `part` of the way from the gall bladder; and its direction.
    [[nodiscard]] filasofia::Vec3 at(const filasofia::FrameRef& frame, double part) const;
    [[nodiscard]] filasofia::Vec3 along_(const filasofia::FrameRef& frame, double part) const;
};

/// What is in the scene file asset:scenes/gallbladder.json, a little different for every seed.
struct GallbladderPatient {
    filasofia::BodyId liver = {}, gallbladder = {}, layer = {};
    filasofia::BodyId assistant = {}; ///< who lifts the fundus
    PatientTube duct = {}, artery = {};
    std::array<std::vector<int>, 2> bed = {}; ///< its nodes on the liver: in its lower third, and above
};
GallbladderPatient addGallbladder(filasofia::Simulation& sim, std::uint64_t seed);

enum InHand { Hook, Applier, Scissors, Bag, Tube };
/// The instruments. The right hand has one of five; the others wait in their cannula.
class GallbladderTools {
public:
    GallbladderTools(filasofia::Simulation& sim, const GallbladderPatient& patient);

    filasofia::LaparoscopicInstrument left;
    filasofia::Laparoscope scope;
    std::array<std::unique_ptr<filasofia::LaparoscopicInstrument>, 5> right;
    filasofia::ClipApplier clips;
    filasofia::SpecimenBag bag; ///< at a roll of 0 its mouth lies level
    filasofia::SuctionIrrigator suction;
    filasofia::TrocarHands hands; ///< its right hand is the hook's: closed jaws are a pressed pedal

    void choose(InHand tool) { chosen_ = tool; } ///< any thread
    [[nodiscard]] InHand chosen() const { return chosen_; }
    std::function<void(filasofia::BodyId)> onClip = {};

private:
    void step();

    filasofia::Simulation& sim_;
    std::atomic<InHand> chosen_ = Hook;
    std::array<bool, 2> was_ = {}; ///< whether the jaws were closed, and for which tool
    InHand held_ = Hook;
};

/// Planned motions.
struct GallbladderMotion {
    filasofia::Simulation& sim;
    const GallbladderPatient& patient;
    GallbladderTools& tools;
    std::function<std::function<void()>(const char* name)> picture; ///< as Motion::picture
};
std::vector<filasofia::TrocarMove> expertMotion(const GallbladderMotion& with);
std::vector<filasofia::TrocarMove> clumsyMotion(const GallbladderMotion& with, std::uint64_t seed);

/// The task as a whole: one session.
int cholecystectomy(const filasofia::Training& training);
std::vector<filasofia::TrainerSetting> settings(); ///< what its case files may change

} // namespace operation

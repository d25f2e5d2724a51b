#include "filasofia/scene/pedals.h"

#include "filasofia/core/error.h"
#include "filasofia/core/word.h"
#include "filasofia/scene/places.h"
#include "filasofia/scene/scene_numbers.h"

#include <algorithm>

namespace filasofia::scene {
namespace {

using event::KeyCode;

constexpr std::string_view kTaken = "FHNPR"; ///< keys of every live run (runtime/keys.h)

/// Unknown if it is none of a letter and a digit.
KeyCode keyNamed(const std::string& name)
{
    if (name.size() != 1) return KeyCode::Unknown;
    const char c = name.front();
    const auto from = [](KeyCode first, int by) { return static_cast<KeyCode>(static_cast<int>(first) + by); };
    if (c >= 'A' && c <= 'Z') return from(KeyCode::A, c - 'A');
    if (c >= 'a' && c <= 'z') return from(KeyCode::A, c - 'a');
    if (c >= '0' && c <= '9') return from(KeyCode::Digit0, c - '0');
    return KeyCode::Unknown;
}

void check(const ScenePedal& pedal, const SceneDef& scene, const Hands& hands, const std::string& path)
{
    if (pedal.key.empty() && !pedal.button) fail(path, ": needs a key or a button");
    const bool taken = pedal.key.size() == 1 && scene.look.keys &&
                       kTaken.find(static_cast<char>(std::toupper(static_cast<unsigned char>(pedal.key[0])))) !=
                           std::string_view::npos;
    if (!pedal.key.empty() && (taken || keyNamed(pedal.key) == KeyCode::Unknown))
        fail(path, ".key must be a letter or a digit, and none of ", kTaken, ", which the run needs, got ",
             shownWord(pedal.key));
    if (pedal.button && std::ranges::find(hands, pedal.body, &Hands::value_type::second) == hands.end())
        fail(path, ".button needs a haptic interface that holds the body");
}

void follow(runtime::Simulation& simulation, const ScenePedal& pedal, const Hands& hands,
            const std::shared_ptr<prefab::SuctionIrrigator>& suction)
{
    const auto set = [&simulation, pedal, suction](bool on) {
        if (suction) return suction->rinse(on);
        if (!pedal.extract) return simulation.activate(pedal.body, on, pedal.electrode);
        surface::Extract now = *pedal.extract;
        if (!on) now.flow = 0.0;
        simulation.extract(now);
    };
    if (!pedal.key.empty()) {
        simulation.on<event::KeyEvent>([set, key = keyNamed(pedal.key)](const event::KeyEvent& e) {
            const event::Modifiers& held = e.modifiers;
            const bool other = e.pressed && (held.control || held.alt || held.super);
            if (e.key == key && !e.repeat && !other) set(e.pressed);
        });
        // The release of a key is not heard in another window.
        simulation.on<event::WindowEvent>([set](const event::WindowEvent& e) {
            if (e.kind == event::WindowEvent::Kind::FocusLost) set(false);
        });
    }
    if (!pedal.button) return;
    const auto hand = std::ranges::find(hands, pedal.body, &Hands::value_type::second)->first;
    simulation.on<runtime::DeviceEvent>([set, hand, button = *pedal.button](const runtime::DeviceEvent& e) {
        if (e.interface == hand && e.notice.kind == device::DeviceNotice::Kind::Button && e.notice.button == button)
            set(e.notice.pressed);
    });
}

/// What rinses while a pedal is pressed; null if the pedal does something else.
std::shared_ptr<prefab::SuctionIrrigator> rinsedBy(const ScenePedal& pedal, const Instruments& instruments,
                                                   const std::string& path)
{
    if (!pedal.rinse) return nullptr;
    if (pedal.extract) fail(path, ".rinse must be false: the pedal has extract");
    const auto found = std::ranges::find(instruments, pedal.body, &Instrument::body);
    if (!pedal.body || found == instruments.end() || !found->suction)
        fail(path, ".body must be an instrument with suction, if it rinses");
    return found->suction;
}

void checkExtract(const runtime::Simulation& simulation, const surface::Extract& extract, const std::string& path)
{
    if (!(extract.flow > 0.0)) fail(path, ".extract.flow must be > 0 m^3/s, got ", extract.flow);
    try {
        simulation.checkExtract(extract);
    } catch (const Error& error) {
        fail(path, ": ", error.what());
    }
}

} // namespace

void addElectrodes(runtime::Simulation& simulation, BodyId id, const std::vector<surface::ElectrodeDef>& electrodes,
                   const std::vector<BodyId>& before)
{
    for (surface::ElectrodeDef each : electrodes) {
        SceneNumbers(before).replaceIn(each);
        simulation.addElectrode(id, each);
    }
}

void checkElectrode(const runtime::Simulation& simulation, BodyId id, int electrode, const std::string& place)
{
    if (const int has = simulation.electrodes(id); electrode >= has)
        fail(place, ".electrode must be in [0, ", has, "), the electrodes of the body, got ", electrode);
}

void followPedals(runtime::Simulation& simulation, const SceneDef& scene, const std::vector<BodyId>& ids,
                  const Instruments& instruments, const Hands& hands)
{
    for (std::size_t i = 0; i < scene.pedals.size(); ++i) try {
            ScenePedal pedal = scene.pedals[i];
            const std::string path = text("pedals[", i, "]");
            const bool instrument = pedal.body.value > scene.bodies.size();
            SceneNumbers(ids).replaceIn(pedal);
            const auto suction = rinsedBy(pedal, instruments, path);
            if (pedal.extract)
                checkExtract(simulation, *pedal.extract, path);
            else if (!pedal.body)
                fail(path, ": needs a body");
            else if (!suction)
                checkElectrode(simulation, pedal.body, pedal.electrode, path);
            if (instrument && pedal.button == 0) fail(path, ".button must not be 0: it closes the jaws");
            check(pedal, scene, hands, path);
            follow(simulation, pedal, hands, suction);
        } catch (const Error& error) {
            failAtPlace(scene.places, error.what());
        }
}

} // namespace filasofia::scene

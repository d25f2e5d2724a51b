#include "filasofia/device/devices.h"

#include "filasofia/core/validate.h"
#include "filasofia/core/word.h"
#include "filasofia/device/drivers.h"

#include <utility>

namespace filasofia::device {
namespace {

const std::pair<const char*, DeviceDef> kNamed[] = {{"mouse", MouseDevice{}},
                                                    {"gamepad", GamepadDevice{}},
                                                    {"spacemouse", SpaceMouseDevice{}},
                                                    {"scripted", ScriptedDevice{}},
                                                    {"forcedimension", ForceDimensionDevice{}},
                                                    {"openhaptics", OpenHapticsDevice{}}};

struct Make {
    const std::string& library;

    std::unique_ptr<HapticDevice> operator()(const MouseDevice& def) const
    {
        return std::make_unique<PersonDevice>(
            "mouse", PersonDevice::Rates{.reach = def.reach, .turn = def.turn, .speed = def.speed});
    }
    std::unique_ptr<HapticDevice> operator()(const GamepadDevice& def) const
    {
        return std::make_unique<PersonDevice>("gamepad",
                                              PersonDevice::Rates{.speed = def.speed, .turnSpeed = def.turnSpeed});
    }
    std::unique_ptr<HapticDevice> operator()(const SpaceMouseDevice& def) const
    {
        return std::make_unique<PersonDevice>("spacemouse",
                                              PersonDevice::Rates{.speed = def.speed, .turnSpeed = def.turnSpeed});
    }
    std::unique_ptr<HapticDevice> operator()(const ScriptedDevice& def) const { return makeScripted(def); }
    std::unique_ptr<HapticDevice> operator()(const ForceDimensionDevice& def) const
    {
        return makeForceDimension(def, library);
    }
    std::unique_ptr<HapticDevice> operator()(const OpenHapticsDevice& def) const
    {
        return makeOpenHaptics(def, library);
    }
};

} // namespace

DeviceDef deviceNamed(const std::string& name)
{
    std::string known;
    for (const auto& [word, def] : kNamed) {
        if (name == word) return def;
        known += text(known.empty() ? "" : ", ", word);
    }
    fail("device: must be one of ", known, ", got ", shownWord(name));
}

std::string nameOf(const DeviceDef& def) { return kNamed[def.index()].first; }

std::unique_ptr<HapticDevice> makeDevice(const DeviceDef& def, const std::string& library)
{
    std::visit([&](const auto& each) { validate(each, text("device ", nameOf(def))); }, def);
    const bool vendors =
        std::holds_alternative<ForceDimensionDevice>(def) || std::holds_alternative<OpenHapticsDevice>(def);
    if (!library.empty() && !vendors)
        fail("device ", nameOf(def), ": library must be empty, because this device needs none; got ",
             shownWord(library));
    return std::visit(Make{library}, def);
}

} // namespace filasofia::device

#include "filasofia/device/drivers.h"

#include "filasofia/core/error.h"

namespace filasofia::device {
namespace {

/// Reports the hand of a motion. It does not yield to forces, so a test can measure them.
class ScriptedDriver final : public HapticDevice {
public:
    ScriptedDriver(std::shared_ptr<const Motion> motion, bool loop) : motion_(std::move(motion)), loop_(loop) {}

    [[nodiscard]] std::string name() const override { return "scripted"; }
    void open() override {}
    void close() noexcept override {}
    [[nodiscard]] Capabilities capabilities() const override
    {
        return {.orientation = true, .force = true, .torque = true, .buttons = 32};
    }
    DeviceSample read(double time) noexcept override { return motion_->at(time, loop_); }
    bool write(const CouplingForce&) noexcept override { return true; }

private:
    std::shared_ptr<const Motion> motion_;
    bool loop_;
};

} // namespace

std::unique_ptr<HapticDevice> makeScripted(const ScriptedDevice& def)
{
    const auto* made = std::get_if<std::shared_ptr<const Motion>>(&def.motion);
    if (made && !*made) fail("device scripted: motion must be the name of a file or a motion, got none");
    if (made) return std::make_unique<ScriptedDriver>(*made, def.loop);
    const std::string& file = std::get<std::string>(def.motion);
    if (file.empty()) fail("device scripted: motion must be the name of a file or a motion, got none");
    return std::make_unique<ScriptedDriver>(std::make_shared<const Motion>(readMotion(file)), def.loop);
}

} // namespace filasofia::device

#pragma once

#include "filasofia/device/haptic_device.h"

#include <functional>
#include <utility>
#include <vector>

namespace filasofia::runtime {

/// A device whose hand the test prescribes, and which records the forces sent to it.
class FakeDevice final : public device::HapticDevice {
public:
    explicit FakeDevice(std::function<device::DeviceSample(double)> where) : where_(std::move(where)) {}

    [[nodiscard]] std::string name() const override { return "fake"; }
    void open() override { ++opened; }
    void close() noexcept override { ++closed; }
    [[nodiscard]] device::Capabilities capabilities() const override
    {
        return {.orientation = true, .force = true, .torque = true, .buttons = 32};
    }
    device::DeviceSample read(double time) noexcept override { return where_(time); }
    bool write(const CouplingForce& onHand) noexcept override
    {
        given.push_back(onHand);
        return true;
    }
    [[nodiscard]] std::string problem() const override { return "the cable"; }

    int opened = 0, closed = 0;
    std::vector<CouplingForce> given;

private:
    std::function<device::DeviceSample(double)> where_;
};

} // namespace filasofia::runtime

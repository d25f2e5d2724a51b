#include "filasofia/runtime/inspector_rates.h"

#include "filasofia/filasofia.h"

#include "visual/gui_person.h"

#include <imgui.h>

namespace inspector_flags_test {

using namespace filasofia;
using namespace filasofia::runtime;
using Catch::Contains;
using physics::StepFlag;
using physics::StepReport;

namespace {

/// The inspector's rates, fed by the test, and the text that a person reads there.
class ReadRates {
public:
    ReadRates()
    {
        visual_.add(GuiDef{.name = "rates", .renderCallback = [this] {
                               ImGui::SetNextWindowSize({500, 580});
                               ImGui::Begin("rates");
                               ImGui::LogToClipboard();
                               rates_.draw();
                               ImGui::LogFinish();
                               const char* copied = ImGui::GetClipboardText();
                               text_ = copied ? copied : "";
                               ImGui::End();
                           }});
        rates_.restart();
    }
    std::string after(const StepReport& report)
    {
        rates_.add(report);
        visual::GuiPerson(visual_).look();
        REQUIRE_THAT(text_, Contains("not converged")); // it was drawn
        return text_;
    }

private:
    Simulation::Impl impl_{{}};
    visual::VisualServer visual_{{.backend = Backend::Null, .width = 800, .height = 600}};
    InspectorRates rates_{impl_};
    std::string text_;
};

} // namespace

TEST_CASE("the inspector tells of elements inside out: how many now, and how many at most")
{
    ReadRates read;
    CHECK_THAT(read.after({.dt = 1e-3}), !Contains("inside out"));
    CHECK_THAT(read.after({.dt = 1e-3, .inverted = {.count = 7}}), Contains("elements inside out 7   at most 7"));
    CHECK_THAT(read.after({.dt = 1e-3, .inverted = {.count = 2}}), Contains("elements inside out 2   at most 7"));
    CHECK_THAT(read.after({.dt = 1e-3}), Contains("elements inside out 0   at most 7"));
}

TEST_CASE("the inspector tells of elements that are strained beyond the range of their material")
{
    ReadRates read;
    CHECK_THAT(read.after({.dt = 1e-3}), !Contains("beyond their range"));
    CHECK_THAT(read.after({.dt = 1e-3, .beyondStrain = {.count = 12}}),
               Contains("elements beyond their range 12   at most 12"));
    CHECK_THAT(read.after({.dt = 1e-3}), Contains("elements beyond their range 0   at most 12"));
}

TEST_CASE("the inspector tells of a body that goes on moving, while it does, and of energy from nowhere")
{
    ReadRates read;
    StepReport restless{.dt = 1e-3, .unrest = {.bodies = 1, .speed = 0.0125, .undriven = 6.0}};
    restless.set(StepFlag::Restless);
    CHECK_THAT(read.after({.dt = 1e-3}), !Contains("not at rest") && !Contains("energy"));
    CHECK_THAT(read.after(restless), Contains("not at rest: 12.5 mm/s, 6.0 s after a drive") && !Contains("energy"));
    restless.set(StepFlag::EnergyGained);
    read.after(restless);
    CHECK_THAT(read.after(restless), Contains("not at rest") && Contains("energy from nowhere in 2 steps"));
    CHECK_THAT(read.after({.dt = 1e-3}), !Contains("not at rest") && Contains("energy from nowhere in 2 steps"));
}

} // namespace inspector_flags_test

#include "apps/filasofia/doctor_report.h"

#include "filasofia/core/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <ostream>

namespace filasofia::app {
namespace {

struct ToText {
    std::string operator()(const std::string& value) const { return value; }
    std::string operator()(bool value) const { return value ? "yes" : "no"; }
    std::string operator()(long long value) const { return text(value); }
    std::string operator()(double value) const { return text(value); }
};

std::string jsonName(std::string name)
{
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
}

} // namespace

void writeTable(const DoctorReport& report, std::ostream& out)
{
    constexpr std::size_t kColumn = 28;
    for (const Section& section : report) {
        out << section.title << '\n';
        for (const Finding& finding : section.findings) {
            const std::size_t width = finding.name.size() + 2;
            out << "  " << finding.name << std::string(width < kColumn ? kColumn - width : 1, ' ')
                << std::visit(ToText(), finding.value);
            if (!finding.unit.empty()) out << ' ' << finding.unit;
            out << '\n';
            if (!finding.hint.empty()) out << std::string(kColumn, ' ') << "-> " << finding.hint << '\n';
        }
    }
}

void writeJson(const DoctorReport& report, std::ostream& out)
{
    nlohmann::ordered_json root;
    for (const Section& section : report) {
        for (const Finding& finding : section.findings) {
            auto& entry = root[section.title][jsonName(finding.name)];
            std::visit([&](const auto& value) { entry["value"] = value; }, finding.value);
            if (!finding.unit.empty()) entry["unit"] = finding.unit;
            if (!finding.hint.empty()) entry["hint"] = finding.hint;
        }
    }
    // A driver's name may hold any bytes. What is not UTF-8 is replaced, as dump() would throw otherwise.
    out << root.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

} // namespace filasofia::app

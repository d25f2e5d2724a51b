#include "filasofia/metric/sample_line.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace filasofia::metric {
namespace {

class Scanner {
public:
    explicit Scanner(std::string_view text) : text_(text) {}

    bool take(std::string_view wanted)
    {
        if (!text_.starts_with(wanted)) return false;
        text_.remove_prefix(wanted.size());
        return true;
    }
    bool number(double& value)
    {
        if (take("null")) return value = kNan, true;
        // from_chars accepts "inf" and "nan", JSON does not.
        const std::size_t digit = text_.starts_with('-') ? 1 : 0;
        if (text_.size() <= digit || text_[digit] < '0' || text_[digit] > '9') return false;
        const auto [end, problem] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
        if (problem != std::errc()) return false;
        text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
        return true;
    }
    [[nodiscard]] bool done() const { return text_.empty(); }

private:
    std::string_view text_;
};

} // namespace

std::optional<Sample> sampleOf(double time, std::span<const double> given)
{
    if (given.size() != kNumbersOfPose && given.size() != kNumbersWithForce && given.size() != kNumbers)
        return std::nullopt;
    std::array<double, kNumbers> n;
    n.fill(kNan);
    n[10] = 0.0;
    std::copy(given.begin(), given.end(), n.begin());
    if (!(n[10] >= 0.0 && n[10] <= 1e9)) return std::nullopt;
    return Sample{.time = time,
                  .pose = {{n[0], n[1], n[2]}, {n[3], n[4], n[5], n[6]}},
                  .force = {n[7], n[8], n[9]},
                  .contacts = static_cast<int>(n[10]),
                  .point = {n[11], n[12], n[13]}};
}

bool scanSampleLine(std::string_view line, std::span<Sample> samples)
{
    Scanner scanner(line);
    double time = 0.0;
    if (!scanner.take("{\"t\":") || !scanner.number(time) || time != time || !scanner.take(",\"s\":[")) return false;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!scanner.take(i == 0 ? "[" : ",[")) return false;
        std::array<double, kNumbers> numbers;
        std::size_t count = 0;
        do {
            if (count == kNumbers || !scanner.number(numbers[count++])) return false;
        } while (scanner.take(","));
        const auto sample = sampleOf(time, std::span(numbers).first(count));
        if (!scanner.take("]") || !sample) return false;
        samples[i] = *sample;
    }
    return scanner.take("]}") && scanner.done();
}

} // namespace filasofia::metric

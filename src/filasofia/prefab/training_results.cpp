#include "filasofia/prefab/training_results.h"

#include "filasofia/core/error.h"
#include "filasofia/core/text.h"
#include "filasofia/metric/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace filasofia::prefab {
namespace {

constexpr const char* kColumns = "date,trainee,case,difficulty,seed,done,time [s],score,session";
constexpr std::size_t kColumnCount = 9;
constexpr std::size_t kLongestLine = 100'000; ///< [bytes]: names are typed text of any length

/// The cells of a line; quotes inside a cell are doubled.
std::vector<std::string> cellsOf(const std::string& line)
{
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
            cells.back() += line[++i];
        else if (line[i] == '"')
            quoted = !quoted;
        else if (line[i] == ',' && !quoted)
            cells.emplace_back();
        else
            cells.back() += line[i];
    }
    return cells;
}

/// A name as a cell of the table gives it back.
std::string asRead(const std::string& name) { return cellsOf(metric::csvCell(name)).front(); }

template <class Number> std::optional<Number> numberOf(const std::string& cell)
{
    Number out{};
    const auto [end, problem] = std::from_chars(cell.data(), cell.data() + cell.size(), out);
    if (problem != std::errc() || end != cell.data() + cell.size()) return std::nullopt;
    return out;
}

std::optional<TrainingRecord> recordOf(const std::string& line)
{
    const std::vector<std::string> cells = cellsOf(line);
    if (cells.size() != kColumnCount) return std::nullopt;
    const auto seed = numberOf<int>(cells[4]);
    const auto seconds = numberOf<double>(cells[6]), score = numberOf<double>(cells[7]);
    if (!seed || !seconds || !std::isfinite(*seconds) || (score && !std::isfinite(*score))) return std::nullopt;
    if (!score && !cells[7].empty()) return std::nullopt;
    if (cells[5] != "yes" && cells[5] != "no") return std::nullopt;
    return TrainingRecord{cells[0], cells[1], cells[2], cells[3], *seed, cells[5] == "yes", *seconds, score, cells[8]};
}

std::string shownScore(double score) { return text(std::lround(score)); }
std::string shownSeconds(double seconds) { return text(std::round(10.0 * seconds) / 10.0, " s"); }

} // namespace

std::vector<TrainingRecord> readResults(const std::string& file)
{
    std::vector<TrainingRecord> out;
    std::error_code none; // a folder or a pipe of that name is not ours
    if (!std::filesystem::is_regular_file(file, none)) return out;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
        if (line.size() < kLongestLine)
            if (auto record = recordOf(line)) out.push_back(std::move(*record));
    return out;
}

void appendResult(const std::string& file, const TrainingRecord& record)
{
    using metric::csvCell;
    std::error_code none;
    const bool isNew = !std::filesystem::exists(file, none);
    std::string lines = isNew ? text(kColumns, '\n') : std::string();
    lines += text(csvCell(record.date), ',', csvCell(record.trainee), ',', csvCell(record.caseName), ',',
                  csvCell(record.difficulty), ',', record.seed, ',', record.done ? "yes" : "no", ',',
                  std::round(1000.0 * record.seconds) / 1000.0, ',', record.score ? text(*record.score) : std::string(),
                  ',', csvCell(record.session), '\n');
    std::ofstream out(file, std::ios::app);
    out << lines << std::flush;
    if (!out) fail(file, ": cannot be written");
}

CaseHistory historyOf(const std::vector<TrainingRecord>& all, const std::string& trainee, const std::string& caseName,
                      const std::string& difficulty)
{
    CaseHistory out;
    const std::string name = asRead(trainee);
    std::vector<const TrainingRecord*> own;
    for (const TrainingRecord& each : all)
        if (each.trainee == name && each.caseName == caseName && each.difficulty == difficulty) own.push_back(&each);
    std::ranges::stable_sort(own, {}, [](const TrainingRecord* each) { return each->date; });
    if (own.empty()) return out;
    out.scored = std::ranges::any_of(own, [](const TrainingRecord* each) { return each->score.has_value(); });
    for (const TrainingRecord* each : own)
        if (out.scored ? each->score.has_value() : each->done)
            out.values.push_back(out.scored ? *each->score : each->seconds);
    const TrainingRecord& last = *own.back();
    out.last = !last.done                 ? "not done"
               : out.scored && last.score ? shownScore(*last.score)
                                          : shownSeconds(last.seconds);
    std::vector<double> whole; // what was broken off is no best
    for (const TrainingRecord* each : own)
        if (each->done && (!out.scored || each->score)) whole.push_back(out.scored ? *each->score : each->seconds);
    if (whole.empty()) return out;
    out.best = out.scored ? shownScore(std::ranges::max(whole)) : shownSeconds(std::ranges::min(whole));
    return out;
}

} // namespace filasofia::prefab

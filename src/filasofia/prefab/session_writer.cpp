#include "filasofia/prefab/session_writer.h"

#include "filasofia/core/error.h"
#include "filasofia/metric/csv.h"
#include "filasofia/metric/session_file.h"

#include <filesystem>

namespace filasofia::prefab {

SessionWriter::SessionWriter(const std::string& file, std::function<void(std::string_view)> function)
    : function_(std::move(function))
{
    if (file.empty()) return;
    const std::string extension = std::filesystem::path(file).extension().string();
    csv_ = extension == ".csv";
    if (!csv_ && extension != ".jsonl") fail("metric tracker: file must end in .jsonl or .csv, got '", file, "'");
    try {
        file_.emplace(file);
    } catch (const Error& error) {
        fail("metric tracker: ", error.what());
    }
}

void SessionWriter::head(const metric::Session& session)
{
    if (function_ || !csv_) lines_ += metric::headLine(session);
    if (csv_) table_ += metric::csvHead(session);
}

void SessionWriter::samples(const metric::Session& session, std::span<const metric::Sample> samples)
{
    if (function_ || (file_ && !csv_)) metric::appendSampleLine(lines_, session, samples);
    if (file_ && csv_) metric::appendCsvLine(table_, session, samples);
}

void SessionWriter::event(const metric::Session& session, const metric::Event& event)
{
    if (function_ || (file_ && !csv_)) lines_ += metric::eventLine(event);
    if (file_ && csv_) table_ += metric::csvLine(session, event);
}

void SessionWriter::back(double time)
{
    if (function_ || (file_ && !csv_)) lines_ += metric::backLine(time);
}

void SessionWriter::end(std::uint64_t lost)
{
    if (function_ || (file_ && !csv_)) lines_ += metric::endLine(lost);
}

void SessionWriter::flush()
{
    if (function_ && !lines_.empty()) function_(lines_);
    if (file_) {
        file_->write(csv_ ? table_ : lines_);
        file_->flush();
    }
    lines_.clear();
    table_.clear();
}

void SessionWriter::close()
{
    flush();
    if (file_) file_->close();
}

} // namespace filasofia::prefab

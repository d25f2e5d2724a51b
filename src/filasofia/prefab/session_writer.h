#pragma once

#include "filasofia/core/output_file.h"
#include "filasofia/metric/session.h"

#include <functional>
#include <optional>
#include <span>
#include <string>

namespace filasofia::prefab {

/// Writes the lines of a session to a file, a function, both or neither. Throws an Error if one of them fails.
class SessionWriter {
public:
    /// `file` ends in .jsonl or .csv, or is empty.
    SessionWriter(const std::string& file, std::function<void(std::string_view)> function);

    // Lines are buffered; flush() writes them.
    void head(const metric::Session& session);
    void samples(const metric::Session& session, std::span<const metric::Sample> samples);
    void event(const metric::Session& session, const metric::Event& event);
    /// What is later than `time` [s] is taken back; not in a .csv file.
    void back(double time);
    void end(std::uint64_t lost);
    [[nodiscard]] bool goesBack() const { return !csv_; }
    [[nodiscard]] std::size_t gathered() const { return lines_.size() + table_.size(); }
    void flush();
    void close();

private:
    std::function<void(std::string_view)> function_;
    std::optional<OutputFile> file_;
    bool csv_ = false;
    std::string lines_; ///< JSON, for the function and a .jsonl file
    std::string table_; ///< for a .csv file
};

} // namespace filasofia::prefab

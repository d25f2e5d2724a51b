#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace filasofia::record {

/// A file being written, emptied first. Every function throws an Error naming it when it cannot be. Only one at a time
/// writes the same regular file, whatever the names by which it is opened, in whatever program.
class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& path);
    ~OutputFile(); ///< closes; whoever wants to hear of problems calls close() before
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(std::string_view text);
    void flush();
    /// The end. Bytes on their way to a full disk, or over a network, may fail only here.
    void close();
    [[nodiscard]] const std::string& name() const { return name_; }
    /// Something has been refused, and told.
    [[nodiscard]] bool failed() const { return failed_; }

private:
    [[noreturn]] void refuse();

    std::string name_;
    std::FILE* file_ = nullptr;
    bool failed_ = false;
};

} // namespace filasofia::record

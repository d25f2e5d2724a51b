#include "filasofia/record/output_file.h"

#include "filasofia/core/error.h"

namespace filasofia::record {

OutputFile::OutputFile(const std::filesystem::path& path) : name_(path.string()), file_(std::fopen(name_.c_str(), "w"))
{
    if (!file_) fail(name_, ": cannot be written");
}

OutputFile::~OutputFile() { std::fclose(file_); }

void OutputFile::write(std::string_view text)
{
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail(name_, ": cannot be written (disk full?)");
}

void OutputFile::flush()
{
    if (std::fflush(file_) != 0) fail(name_, ": cannot be written (disk full?)");
}

} // namespace filasofia::record

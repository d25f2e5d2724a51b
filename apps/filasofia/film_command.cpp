#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"

#include "filasofia/core/error.h"
#include "filasofia/core/text.h"
#include "filasofia/runtime/avi_file.h"
#include "filasofia/visual/image.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>

namespace filasofia::app {
namespace {

namespace fs = std::filesystem;

struct FilmCommandOptions {
    std::string file = "film.avi";
    std::string only;
    double speed = 8.0;
    int steps = 0;
};

constexpr double kFilmRate = 24.0; ///< [1/s], pictures of the film
constexpr int kFilmWidth = 960, kFilmHeight = 720;

struct FilmScene {
    const char* program;
    const char* caseName;
    const char* seed;
};
/// Seeds whose experts the docs show.
constexpr std::array kFilmScenes = {
    FilmScene{"hysteroscopy", "medium", "2"},       FilmScene{"hysteroscopy", "resection", "1"},
    FilmScene{"laparoscopy", "peg-transfer", "2"},  FilmScene{"laparoscopy", "pattern-cutting", "3"},
    FilmScene{"laparoscopy", "ligating-loop", "3"}, FilmScene{"laparoscopy", "cannulation", "3"},
    FilmScene{"laparoscopy", "suturing", "18"},     FilmScene{"laparoscopy", "cholecystectomy", "1"}};

/// Runs a program to its end without its output; returns its exit code, or -1 if it was ended.
int ran(const std::string& program, const std::vector<std::string>& words)
{
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    std::vector<char*> arguments{const_cast<char*>(program.c_str())}; // execve(2) takes them as non-const
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    pid_t process = -1;
    const int problem = posix_spawn(&process, program.c_str(), &files, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (problem != 0) fail("film: the program '", program, "' cannot be started: ", std::strerror(problem));
    int status = 0;
    waitpid(process, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// The pictures of a video of `--video`, each as a JPEG. What is cut off ends it.
std::vector<std::string> picturesIn(const fs::path& video)
{
    std::ifstream in(video, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    std::vector<std::string> out;
    std::size_t at = bytes.find("movi");
    for (at = at == std::string::npos ? bytes.size() : at + 4; at + 8 <= bytes.size();) {
        if (bytes.compare(at, 4, "00dc") != 0) break;
        std::size_t size = 0;
        for (std::size_t i = 4; i-- > 0;) size = 256 * size + static_cast<unsigned char>(bytes[at + 4 + i]);
        if (at + 8 + size > bytes.size()) break;
        out.push_back(bytes.substr(at + 8, size));
        at += 8 + size + size % 2;
    }
    return out;
}

/// The picture in the middle of one of the film's size, with black around it.
std::vector<unsigned char> framed(const visual::Image& image)
{
    std::vector<unsigned char> out(4UL * kFilmWidth * kFilmHeight, 0);
    const int width = std::min(image.width, kFilmWidth), height = std::min(image.height, kFilmHeight);
    const int left = (kFilmWidth - width) / 2, top = (kFilmHeight - height) / 2;
    for (int y = 0; y < height; ++y)
        std::copy_n(image.rgba.begin() + 4L * image.width * y, 4L * width,
                    out.begin() + 4L * (kFilmWidth * (top + y) + left));
    return out;
}

/// A folder that is gone at the end.
struct FilmFolder {
    const fs::path place = fs::temp_directory_path() / text("filasofia_film_", getpid());
    FilmFolder() { fs::create_directories(place); }
    ~FilmFolder()
    {
        std::error_code none;
        fs::remove_all(place, none);
    }
    FilmFolder(const FilmFolder&) = delete;
    FilmFolder& operator=(const FilmFolder&) = delete;
};

int addScene(const FilmScene& scene, const FilmCommandOptions& options, const FilmFolder& folder,
             runtime::AviFile& film)
{
    const fs::path piece = folder.place / "piece.avi", picture = folder.place / "picture.jpg";
    const std::string program = (fs::read_symlink("/proc/self/exe").parent_path() / scene.program).string();
    std::vector<std::string> words = {"--case",
                                      scene.caseName,
                                      "--seed",
                                      scene.seed,
                                      "--motion",
                                      "expert",
                                      "--headless",
                                      "--session",
                                      (folder.place / "piece.jsonl").string(),
                                      "--video",
                                      piece.string(),
                                      "--fps",
                                      text(kFilmRate / options.speed)};
    if (options.steps > 0) words.insert(words.end(), {"--steps", text(options.steps)});
    if (const int code = ran(program, words); code != 0)
        fail("film: ", scene.program, " --case ", scene.caseName, " ended with exit code ", code);
    int count = 0;
    for (const std::string& jpeg : picturesIn(piece)) {
        std::ofstream(picture, std::ios::binary) << jpeg;
        film.add(framed(visual::loadImage(picture)));
        ++count;
    }
    return count;
}

int film(const FilmCommandOptions& options)
{
    if (fs::path(options.file).extension() != ".avi")
        fail("film: FILE must end in .avi, got ", shownWord(options.file));
    const auto wanted = [&](const FilmScene& scene) {
        return options.only.empty() || options.only == scene.program || options.only == scene.caseName;
    };
    if (std::ranges::none_of(kFilmScenes, wanted)) {
        std::string names = "hysteroscopy, laparoscopy";
        for (const FilmScene& scene : kFilmScenes) names += text(", ", scene.caseName);
        fail("film: --only must be one of ", names, ", got ", shownWord(options.only));
    }
    const FilmFolder folder;
    runtime::AviFile film(options.file, kFilmWidth, kFilmHeight, kFilmRate);
    int pictures = 0;
    for (const FilmScene& scene : kFilmScenes) {
        if (!wanted(scene)) continue;
        const int count = addScene(scene, options, folder, film);
        std::cout << scene.program << ' ' << scene.caseName << ": " << count << " pictures\n" << std::flush;
        pictures += count;
    }
    film.close();
    std::cout << "wrote " << oneLine(options.file) << ": " << text(std::round(10 * pictures / kFilmRate) / 10) << " s, "
              << text(std::round(static_cast<double>(fs::file_size(options.file)) / 1e5) / 10) << " MB\n";
    return 0;
}

} // namespace

Command filmCommand()
{
    // Static: there is one command line, and its targets must outlive this function.
    static FilmCommandOptions options;
    return {.name = "film",
            .meaning = "Film the experts of all trainers, one after the other, as one video",
            .options = {{"FILE", &options.file, "The video, a .avi (Motion JPEG)", "FILE"},
                        {.name = "--speed",
                         .target = &options.speed,
                         .meaning = "Simulated seconds per second of the film",
                         .bound = {closed(1, 24), "-"}},
                        {"--only", &options.only, "Only this trainer, or only this case", "NAME"},
                        {.name = "--steps",
                         .target = &options.steps,
                         .meaning = "Only so many steps of each expert; 0: all",
                         .bound = {closed(0, 1e9), "-"}}},
            .run = [] { return film(options); },
            .footer = "The trainers must be beside this program. docs/guide/showing.md has more on videos."};
}

} // namespace filasofia::app

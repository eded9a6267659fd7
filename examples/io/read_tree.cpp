#include <io/read_tree.hpp>

#include <io/read_mtg.hpp>
#include <io/read_qsm.hpp>
#include <io/read_skeleton_json.hpp>
#include <io/settle.hpp>
#include <io/text_input.hpp>
#include <skybark/trees/species.hpp>

#include <algorithm>
#include <filesystem>

namespace skybark::io {

namespace {

/// The extension in lower case, with its dot.
std::string extension_of(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return extension;
}

} // namespace

result<std::vector<trees::segment>> read_tree(const std::string& path_or_species,
                                              std::uint32_t seed) {
    if (const auto* species = trees::find_species(path_or_species); species != nullptr)
        return trees::grow(species->parameters, seed);
    const std::string extension = extension_of(path_or_species);
    if (extension == ".csv" || extension == ".tsv" || extension == ".txt")
        return read_qsm(path_or_species, placement::settled);
    if (extension == ".json")
        return read_skeleton_json(path_or_species, seed);
    if (extension == ".mtg") {
        auto tree = read_mtg(path_or_species);
        if (tree)
            settle(*tree);
        return tree;
    }
    std::string known;
    for (const auto& entry : trees::all_species())
        known += (known.empty() ? " " : ", ") + std::string(entry.name);
    return fail(
        error_code::bad_input,
        in_quotes(path_or_species) +
            " is no tree that can be read; expected a file of cylinders (.csv, .tsv, "
            ".txt), a multiscale tree graph (.mtg), a description (.json) or one of the species" +
            known + ".");
}

} // namespace skybark::io

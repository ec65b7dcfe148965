// palpate-io-helper: reads or writes one volume, or reads a mesh, and reports as described in
// protocol.hpp. It exists so that a crash of a format's library does not crash the caller. It reads
// NRRD, MetaImage, NIfTI, MGH, MRC and VTK's older format itself. For all other formats it becomes
// the program that has the library, so that only needed libraries are loaded.
#include <unistd.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "io/helper/jobs.hpp"
#include "io/helper/report.hpp"
#include "io/tiff_peek.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

constexpr const char *dicom = "palpate-io-dicom", *images = "palpate-io-images",
                     *itk = "palpate-io-itk", *vtk = "palpate-io-vtk";

/// Null for what needs a library.
const Formats* own_formats(Job job, const fs::path& path) {
    static constexpr Formats by_header{.read = &read_by_header, .locate = &locate_by_header};
    std::error_code error;
    if ((job != Job::read && job != Job::locate) || fs::is_directory(path, error)) return nullptr;
    return header_reader(path) ? &by_header : nullptr;
}

/// Whether a file of this name is a volume, whole.
bool names_a_volume(const fs::path& path) {
    return header_reader(path) || extension_of(path) == ".vti";
}

/// "a.nrrd, b.nrrd and 3 more"
std::string listed(std::vector<std::string> names) {
    constexpr std::size_t most = 3;
    std::ranges::sort(names);
    std::string text;
    for (std::size_t i = 0; i < std::min(most, names.size()); ++i) {
        text += (i > 0 ? ", " : "") + names[i];
    }
    return names.size() > most ? text + " and " + std::to_string(names.size() - most) + " more"
                               : text;
}

/// The program for a folder of slices.
const char* program_for_folder(const fs::path& folder) {
    if (has_dicom_index(folder)) return dicom;
    int dicoms = 0, tiffs = 0;
    bool folders = false, has_names = false;
    std::vector<std::string> volumes;
    for (const auto& entry : fs::directory_iterator(folder)) {
        std::error_code error;  // of a link to itself
        folders |= entry.is_directory(error);
        if (is_dangling_link(entry)) {  // of a slice that the other program names
            has_names = has_names || has_dicom_name(entry.path());
            tiffs += dicoms == 0 && tiffs < 2 && is_tiff_name(entry.path());
        }
        if (!is_shown_file(entry)) continue;
        if (names_a_volume(entry.path())) volumes.push_back(entry.path().filename().string());
        // Not every one of ten thousand has to be looked into.
        has_names = has_names || has_dicom_name(entry.path());
        dicoms += dicoms < 2 && looks_like_dicom(entry.path());
        tiffs += dicoms == 0 && tiffs < 2 && is_tiff_name(entry.path());
    }
    if (!volumes.empty() && dicoms + tiffs <= 1) {
        throw Failure(std::string("is a folder of volumes") +
                      (dicoms + tiffs == 1 ? " with a single slice" : "") + ": give one of them (" +
                      listed(volumes) + ")" + (dicoms + tiffs == 1 ? ", or the slice itself" : ""));
    }
    if (dicoms > 0) return dicom;
    if (tiffs > 0) return images;
    if (has_names) return dicom;  // which says what is wrong with them
    throw Failure(std::string("is a folder with no DICOM or TIFF slices in it; ") +
                  (folders ? "give one of the folders in it, or a volume file"
                           : "give a volume file or another folder"));
}

/// What to do with a file of a format that is not read; empty for an extension that names none.
std::string advice_for(const std::string& extension) {
    struct Advice {
        std::string_view extensions, words;
    };
    constexpr Advice advices[] = {
        {".raw .raw.gz",
         "has nothing but samples; give its dims and type (--dims 256x256x128 --type uint8)"},
        {".zip .gz .bz2 .xz .zst .7z .tar .ozx", "is packed; unpack it and give what is in it"},
        {".mnc .mnc2 .minc", "is a MINC file, which is not read; convert it with mnc2nii"},
        {".mif .mih",
         "is an image of MRtrix, which is not read; convert it with mrconvert IN OUT.nii"},
        {".par", parrec_advice},
        {".head .brik .brik.gz",
         "is an image of AFNI, which is not read; convert it with 3dAFNItoNIFTI"},
        {".npy .npz .mat",
         "is an array of NumPy or MATLAB, which is not read; in Python, make a palpate.Volume of "
         "it, "
         "or save it as .nrrd, .nii or .tif"},
        {".h5 .hdf5 .hdf .ims",
         "is an HDF5 file: those of Imaris and BigDataViewer are read in parts, as a store; of "
         "another one, save the volume as .nrrd, .nii or .tif"},
        {".czi .nd2 .lif .oib .oif .vsi .dv",
         "is of a microscope's own format, which is not read; save it as OME-TIFF (Fiji) or "
         "OME-Zarr "
         "(bioformats2raw)"},
        {".pvti .vtr .vts .vtu .pvd .vtm",
         "is of a format of VTK that is not read; save it as an image in one file (.vti)"},
        {".png .jpg .jpeg .bmp .jp2 .gif",
         "is a picture, not a volume; save its slices as one TIFF file, or as a folder of them"}};
    const std::string last = extension.substr(std::min(extension.rfind('.'), extension.size()));
    for (const std::string& wanted : {extension, last}) {
        for (const auto& [extensions, words] : advices) {
            std::istringstream names{std::string(extensions)};
            for (std::string name; names >> name;) {
                if (name == wanted) return std::string(words);
            }
        }
    }
    return "";
}

const char* program_for_file(const fs::path& path) {
    if (fs::is_directory(path)) return program_for_folder(path);
    const std::string extension = extension_of(path);
    if (extension == ".vti") return vtk;
    if (is_tiff_name(path)) return images;
    if (has_dicom_name(path) || begins_as_dicom(path)) return dicom;
    if (begins_as_tiff(path)) return images;
    if (extension.starts_with(".hdr") || extension.starts_with(".img")) {
        throw Failure(
            "is one of a pair of files (.hdr and .img), and the other is not beside it; put it "
            "there, or save the pair as one .nii file");
    }
    if (const std::string advice = advice_for(extension); !advice.empty()) throw Failure(advice);
    if (begins_as_hdf5(path)) throw Failure(advice_for(".h5"));  // NeXus, netCDF and others
    throw Failure(
        "has no extension of a known format (nrrd, nhdr, mha, mhd, nii, nii.gz, mgh, mgz, mrc, "
        "dcm, tif, vti, vtk); if it holds nothing but samples, give its dims and type");
}

const char* program_for(Job job, const fs::path& path) {
    const std::string extension = extension_of(path);
    switch (job) {
        case Job::read:
            return program_for_file(path);
        case Job::explore:
            return images;
        case Job::read_mesh:
            return vtk;
        case Job::write:
            return extension == ".vti"                           ? vtk
                   : extension == ".tif" || extension == ".tiff" ? images
                                                                 : itk;
        case Job::locate:
            (void)program_for_file(path);
            throw Failure(
                "is of a format that is read as a whole and not piece by piece; convert it to "
                "OME-Zarr");
        case Job::none:
            break;
    }
    return itk;
}

/// Does not return if the program is there.
nlohmann::json become(const char* program, char** argv) {
    const fs::path path = fs::read_symlink("/proc/self/exe").parent_path() / program;
    execv(path.c_str(), argv);
    throw Failure("needs " + path.string() + ", which is not there; reinstall Palpate");
}

int run(int argc, char** argv) {
    constexpr const char* name = "palpate-io-helper";
    const Job job = job_of(argc, argv);
    const Formats* own = job == Job::none ? nullptr : own_formats(job, argv[2]);
    if (own) serve(name, *own, argc, argv);
    return helper_status(
        name, job != Job::none, [&] { return become(program_for(job, argv[2]), argv); },
        [&](const std::exception& e) { return words_of(e, job); });
}

}  // namespace
}  // namespace palpate::io

int main(int argc, char** argv) {
    return palpate::io::run(argc, argv);
}

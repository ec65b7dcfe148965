// A page of a TIFF file. See the header.
#include "io/helper/tiff_page.hpp"

namespace palpate::io {

namespace fs = std::filesystem;

namespace {

Stored stored_from(std::uint16_t bits, std::uint16_t format, const fs::path& file) {
    const std::string kind = format == SAMPLEFORMAT_IEEEFP                                ? "float"
                             : format == SAMPLEFORMAT_INT                                 ? "int"
                             : format == SAMPLEFORMAT_UINT || format == SAMPLEFORMAT_VOID ? "uint"
                                                                                          : "";
    if (kind == "uint" && bits > 0 && bits < 16) return bits > 8 ? Stored::uint16 : Stored::uint8;
    if (const auto stored = stored_named(kind + std::to_string(bits))) return *stored;
    throw Failure(quoted(file) + " has samples of " + std::to_string(bits) +
                  " bits of a kind that is not read; save it " +
                  (format == SAMPLEFORMAT_IEEEFP ? "as 32-bit float" : "with 8 or 16 bits"));
}

}  // namespace

void fail_damaged_tiff(const fs::path& file) {
    throw Failure(quoted(file) + " is damaged or cut off (" +
                  (first_tiff_error().empty() ? "libtiff" : first_tiff_error()) +
                  "); copy it again");
}

Tiff open_to_read(const fs::path& file, const std::string& more) {
    Tiff tiff = open_tiff(file, ("rM" + more).c_str());  // M: not mapped, a short file is an error
    if (!tiff) {
        const std::string& why = first_tiff_error();
        throw Failure(quoted(file) + " is no TIFF file or is damaged" +
                      (why.empty() ? "" : " (" + why + ")") + "; check its name or copy it again");
    }
    return tiff;
}

std::string text_of(const TiffPage& page) {
    return std::to_string(page.width) + "x" + std::to_string(page.height) + " of " +
           (page.is_packed() ? std::to_string(page.bits) + " bits" : name_of(page.stored)) +
           (page.orientation == ORIENTATION_TOPLEFT
                ? ""
                : " (Orientation " + std::to_string(page.orientation) + ")");
}

TiffPage page_of(TIFF* tiff, const fs::path& file, std::vector<std::string>& notes) {
    std::uint16_t samples = 1, bits = 1, format = SAMPLEFORMAT_UINT,
                  photometric = PHOTOMETRIC_MINISBLACK;
    TiffPage page;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &page.width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &page.height);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
    std::uint32_t depth = 1;
    if (TIFFGetField(tiff, TIFFTAG_IMAGEDEPTH, &depth) != 0 && depth > 1) {
        throw Failure(
            quoted(file) + " has pages of " + std::to_string(depth) +
            " slices each (a volumetric TIFF, ImageDepth), which is not read; save a page "
            "for each slice");
    }
    // MetaMorph's .stk: the planes follow each other behind the first, which alone TIFF knows of.
    constexpr std::uint32_t metamorph_planes = 33629;
    std::uint32_t planes = 0;
    const void* ignored = nullptr;
    if (TIFFGetField(tiff, metamorph_planes, &planes, &ignored) != 0 && planes > 1) {
        throw Failure(quoted(file) + " is a stack of MetaMorph with " + std::to_string(planes) +
                      " planes behind one page, which is not read; save a page for each slice");
    }
    const bool is_grey = photometric <= PHOTOMETRIC_MINISBLACK ||
                         photometric == PHOTOMETRIC_PALETTE || photometric == PHOTOMETRIC_MASK;
    if (samples != 1 && photometric <= PHOTOMETRIC_MINISBLACK) {
        throw Failure(quoted(file) + " has " + std::to_string(samples) +
                      " values in each pixel (channels or slices in one page); save each of them "
                      "as a page");
    }
    if (samples != 1 || !is_grey) {
        throw Failure(quoted(file) + " has colours (" + std::to_string(samples) +
                      " values a sample, PhotometricInterpretation " + std::to_string(photometric) +
                      "); save it in grey");
    }
    if (photometric == PHOTOMETRIC_MINISWHITE) {
        add_note(notes, "its zero means white: values were taken as they are");
    }
    if (photometric == PHOTOMETRIC_PALETTE) {
        add_note(notes, "its palette of colours was not used: values were taken as they are");
    }
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &page.orientation);
    if (page.orientation != ORIENTATION_TOPLEFT) {
        add_note(notes, "its Orientation " + std::to_string(page.orientation) +
                            " was not applied: rows and columns were taken as they are stored");
    }
    std::uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    if (TIFFIsCODECConfigured(compression) == 0) {  // 33003, 33005 and 34712 are JPEG 2000
        throw Failure(quoted(file) + " has a compression that is not read (TIFF number " +
                      std::to_string(compression) + "); save it with deflate, LZW or zstd");
    }
    page.stored = stored_from(bits, format, file);
    page.bits = bits;
    return page;
}

}  // namespace palpate::io

#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "scene/hbImage8.h"
#include "scene/hbPicture.h"

/// How much a picture differs from a reference of the same size. Sums are in 64 bits, row by row.
struct hbPictureDifference {
  double max = 0.0;  ///< The greatest absolute difference of two values; infinite where only one is NaN.
  double rmse = 0.0; ///< Root mean square of the differences.
  /// 20 log10(peak / rmse) in dB; none where nothing differs, and where the peak is 0.
  std::optional<double> psnr;
  /// Mean structural similarity of the displayed luma, 1 for equal pictures; none below 11 pixels a side.
  std::optional<double> ssim;
  double luvMean = 0.0; ///< Mean distance of the displayed colours in CIE 1976 L*u*v* (D65).
  double luvMax = 0.0;
};

namespace hb {

/// Of images: values are the bytes of all three channels, the peak is 255. Throws hbError naming both for unlike sizes.
hbPictureDifference pictureDifference(const hbImage8& a, const hbImage8& b, const std::string& nameA = "picture A",
                                      const std::string& nameB = "picture B");

/// Of float pictures: values are those of channel "Y" (where neither has it, of the first channel by name that both
/// have), covered or not; the peak is the range of a's finite values. NaN in both is no difference, NaN in one an
/// infinite one. SSIM and L*u*v* compare the two as displayed by a's scene (kept in its metadata, otherwise the
/// default) with a's window, so that equal values look equal. Throws hbError naming both for unlike sizes or no common
/// channel, and naming a where its scene cannot be read.
hbPictureDifference pictureDifference(const hbPicture& a, const hbPicture& b, const std::string& nameA = "picture A",
                                      const std::string& nameB = "picture B");

/// Of two files, both .exr or both .png; throws hbError as their readers and the functions above do.
hbPictureDifference pictureFileDifference(const std::filesystem::path& a, const std::filesystem::path& b);

/// Mean SSIM: Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli, "Image Quality Assessment: From Error Visibility to
/// Structural Similarity", IEEE Trans. Image Processing 13(4), 2004, equation 13, with the paper's constants: Gaussian
/// windows of 11 x 11 pixels with sigma 1.5, K1 = 0.01, K2 = 0.03, L = 255. It is taken of the luma
/// 0.299 R + 0.587 G + 0.114 B of the stored values and averaged over the windows that lie fully inside. None for
/// images below 11 pixels a side. The images have equal sizes.
std::optional<double> ssim(const hbImage8& a, const hbImage8& b);

} // namespace hb

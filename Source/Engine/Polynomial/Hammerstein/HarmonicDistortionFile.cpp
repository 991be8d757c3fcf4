// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Hammerstein/HarmonicDistortionFile.h"

#include "Engine/Document/CsvText.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"

namespace excursion {
namespace {

std::vector<double> curveColumn(const Eigen::MatrixXd& values, Eigen::Index column)
{
    const Eigen::VectorXd one = values.col(column);
    return {one.begin(), one.end()};
}

}  // namespace

nlohmann::ordered_json toJson(const HarmonicDistortion& distortion)
{
    nlohmann::ordered_json document = DocumentFormat {"excursion-harmonics"}.with(
        {{"highest", distortion.highest},
         {"response", distortion.response},
         {"band", {distortion.bandLow, distortion.bandHigh}},
         {"remarks", distortion.remarks}});
    document["curves"] = nlohmann::ordered_json::array();
    for (const auto& c : distortion.curves) {
        nlohmann::ordered_json curve {{"channel", name(c.quantity)}, {"unit", c.unit}, {"level", c.level}};
        curve["frequency"] = curveJson(c.frequency);
        curve["fundamental"] = curveJson(c.fundamental);
        curve["harmonics"] = nlohmann::ordered_json::array();
        for (int m = 2; m <= distortion.highest; ++m)
            curve["harmonics"].push_back({{"order", m},
                                          {"db", curveJson(curveColumn(c.db, m - 2))},
                                          {"floorDb", curveJson(curveColumn(c.floorDb, m - 2))}});
        curve["thd"] = {{"db", curveJson(c.thdDb)}, {"floorDb", curveJson(c.thdFloorDb)}};
        document["curves"].push_back(std::move(curve));
    }
    return document;
}

std::string harmonicsCsv(const HarmonicDistortion& distortion)
{
    std::string text = "channel,level V rms,frequency Hz,fundamental rms,unit";
    for (int m = 2; m <= distortion.highest; ++m)
        text += ",H" + std::to_string(m) + " dB,H" + std::to_string(m) + " floor dB";
    text += ",THD dB,THD floor dB\n";
    for (const auto& c : distortion.curves)
        for (std::size_t i = 0; i < c.frequency.size(); ++i) {
            const auto row = static_cast<Eigen::Index>(i);
            text += std::string(name(c.quantity)) + "," + csvNumber(c.level) + "," + csvNumber(c.frequency[i]) + ","
                    + csvNumber(c.fundamental[i]) + "," + csvText(c.unit);
            for (Eigen::Index m = 0; m < c.db.cols(); ++m)
                text += "," + csvNumber(c.db(row, m)) + "," + csvNumber(c.floorDb(row, m));
            text += "," + csvNumber(c.thdDb[i]) + "," + csvNumber(c.thdFloorDb[i]) + "\n";
        }
    return text;
}

}  // namespace excursion

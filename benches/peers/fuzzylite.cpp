// Times fuzzylite on a system written by the example `peers`: fuzzylite NAME FOLDER
// prints `system,program,ns per call,largest error in % of the range` for 100 and 1000 samples.
#include <fl/Headers.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <vector>

int main(int, char** arguments) {
    const std::string name = arguments[1], folder = arguments[2];
    for (int samples : {100, 1000}) {
        std::unique_ptr<fl::Engine> engine(fl::FllImporter().fromFile(folder + "/" + name + ".fll"));
        fl::OutputVariable* output = engine->getOutputVariable(0);
        auto integral = dynamic_cast<fl::IntegralDefuzzifier*>(output->getDefuzzifier());
        if (integral) integral->setResolution(samples);
        else if (samples > 100) break;  // Takagi-Sugeno does not sample.
        std::vector<std::vector<double>> rows;
        std::ifstream file(folder + "/" + name + ".points");
        for (std::string line; std::getline(file, line);) {
            std::istringstream words(line);
            std::vector<double> row;
            for (std::string word; words >> word;) row.push_back(std::strtod(word.c_str(), nullptr));
            rows.push_back(row);
        }
        const size_t inputs = engine->numberOfInputVariables();
        double best = INFINITY, error = 0;
        const auto begun = std::chrono::steady_clock::now();
        do {
            const auto start = std::chrono::steady_clock::now();
            for (const auto& row : rows) {
                for (size_t i = 0; i < inputs; ++i) engine->getInputVariable(i)->setValue(row[i]);
                engine->process();
                const double difference = std::fabs(output->getValue() - row[inputs]);
                if (difference > error) error = difference;
            }
            const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
            best = std::min(best, took.count());
        } while (std::chrono::steady_clock::now() - begun < std::chrono::milliseconds(1500));
        const std::string how = integral ? " " + std::to_string(samples) + " samples" : "";
        std::printf("%s,fuzzylite %s (C++)%s,%g,%.2g\n", name.c_str(), fl::fuzzylite::version().c_str(), how.c_str(),
                    best * 1e9 / rows.size(), 100 * error / output->range());
    }
}

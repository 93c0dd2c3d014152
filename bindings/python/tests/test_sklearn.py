"""The estimators for scikit-learn."""

import pickle

import numpy as np
import pytest

pytest.importorskip("sklearn", reason="scikit-learn is not installed: `pip install flagred[sklearn]`")

from sklearn.base import clone
from sklearn.datasets import load_breast_cancer, load_diabetes, load_iris
from sklearn.metrics import roc_auc_score
from sklearn.model_selection import GridSearchCV, GroupKFold, cross_val_predict, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import parametrize_with_checks

import flagred
from flagred.sklearn import ConformalRegressor, FuzzyClassifier, FuzzyRegressor, FuzzyRiskClassifier


@parametrize_with_checks([ConformalRegressor(), FuzzyClassifier(), FuzzyRegressor(), FuzzyRiskClassifier()])
def test_scikit_learn_checks(estimator, check):
    check(estimator)


@pytest.fixture(scope="module")
def wave():
    random = np.random.default_rng(1)
    X = random.uniform(0, 6, (400, 2))
    return X, np.sin(X[:, 0]) + 0.5 * X[:, 1]


def test_a_surface_is_learned_by_rules_that_people_read(wave):
    X, y = wave
    regressor = FuzzyRegressor(n_terms=5, n_output_terms=7).fit(X[:300], y[:300])
    assert regressor.score(X[300:], y[300:]) > 0.9
    assert 10 <= regressor.n_rules_ == len(regressor.rule_set_.rules) <= 25
    assert regressor.rule_set_.rules[0].text.startswith("IF x0 IS very_low AND x1 IS ")
    untuned = clone(regressor).set_params(tune=False).fit(X[:300], y[:300])
    assert untuned.score(X[:300], y[:300]) < regressor.score(X[:300], y[:300])


def test_predictions_are_those_of_the_rule_set(wave):
    X, y = wave
    regressor = FuzzyRegressor().fit(X, y)
    found = regressor.predict(X[:50])
    rule_set = flagred.loads(regressor.rule_set_.to_yaml())
    assert [rule_set(*row) for row in X[:50].tolist()] == found.tolist()
    assert pickle.loads(pickle.dumps(regressor)).predict(X[:50]).tolist() == found.tolist()
    explained = regressor.explain(X[:3])
    assert [one.outputs[0].value for one in explained] == found[:3].tolist()


def test_names_come_from_a_frame(wave):
    pandas = pytest.importorskip("pandas")
    X, y = wave
    frame = pandas.DataFrame(X, columns=["wind speed", "y"])
    regressor = FuzzyRegressor(monotonic_cst={"y": 1}).fit(frame, y)
    assert [*regressor.rule_set_.inputs] == ["wind speed", "y_in"]
    assert regressor.predict(frame).tolist() == FuzzyRegressor(monotonic_cst=[0, 1]).fit(X, y).predict(X).tolist()


@pytest.mark.parametrize("spacing", ["quantile", "uniform"])
def test_partitions_are_made_from_the_data(spacing):
    x = np.concatenate((np.linspace(0, 1, 90), np.linspace(2, 10, 10)))[:, None]
    x = np.column_stack((x, np.arange(100) % 2, np.full(100, 7.0)))
    model = FuzzyRegressor(n_terms=4, spacing=spacing, tune=False).fit(x, x[:, 0]).rule_set_.to_dict()
    peaks = [[*variable["partition"].values()] for variable in model["inputs"]]
    if spacing == "uniform":
        assert np.allclose(peaks[0], [0, 10 / 3, 20 / 3, 10])
    else:
        assert peaks[0][2] < 1 and peaks[1] == [0, 1]
    assert peaks[2][0] < 7 < peaks[2][-1]


@pytest.mark.parametrize("tune", [False, True])
def test_monotone_constraints_hold(tune):
    random = np.random.default_rng(2)
    X = random.uniform(0, 1, (200, 2))
    y = X[:, 0] - X[:, 1] + random.normal(0, 0.5, 200)
    grid = np.linspace(0, 1, 60)
    other, along = (axis.ravel() for axis in np.meshgrid(grid, grid, indexing="ij"))
    regressor = FuzzyRegressor(n_terms=4, monotonic_cst=[1, -1], tune=tune).fit(X, y)
    rising = regressor.predict(np.column_stack((along, other))).reshape(60, 60)
    falling = regressor.predict(np.column_stack((other, along))).reshape(60, 60)
    assert np.all(np.diff(rising, axis=1) >= -1e-12) and np.all(np.diff(falling, axis=1) <= 1e-12)
    assert np.ptp(rising) > 0.5
    risk = FuzzyRiskClassifier(n_terms=4, monotonic_cst=[1, -1], tune=tune).fit(X, y > 0)
    assert np.all(np.diff(risk.predict_proba(np.column_stack((along, other)))[:, 1].reshape(60, 60)) >= -1e-12)


def test_probabilities_rank_and_stay_in_0_to_1():
    data = load_breast_cancer()
    X = data.data[:, [1, 20, 27]]
    pipeline = make_pipeline(StandardScaler(), FuzzyRiskClassifier())
    found = cross_val_predict(pipeline, X, data.target, cv=3, method="predict_proba")
    assert np.all((found >= 0) & (found <= 1)) and np.allclose(found.sum(axis=1), 1)
    assert roc_auc_score(data.target, found[:, 1]) > 0.95


def test_groups_stay_together_in_cross_validation(wave):
    X, y = wave
    groups = np.arange(len(y)) % 4
    scores = cross_val_score(FuzzyRegressor(iterations=5), X, y, groups=groups, cv=GroupKFold(4))
    assert len(scores) == 4 and scores.min() > 0.5


def test_a_grid_is_searched():
    X, y = load_diabetes(return_X_y=True)
    search = GridSearchCV(FuzzyRegressor(iterations=5), {"n_terms": [2, 3]}, cv=3).fit(X[:, [2, 8]], y)
    assert search.best_score_ > 0.3


def test_weights_are_used(wave):
    X, y = wave
    one = FuzzyRegressor(tune=False).fit(X, y, sample_weight=np.where(X[:, 0] < 3, 1, 0))
    two = FuzzyRegressor(tune=False).fit(X[X[:, 0] < 3], y[X[:, 0] < 3])
    assert one.rule_set_ == two.rule_set_


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"n_terms": 1}, "n_terms is 1"),
        ({"spacing": "even"}, "spacing is 'even'"),
        ({"monotonic_cst": [1]}, "for each of the 2 features"),
        ({"monotonic_cst": {"x7": 1}}, "'x7', which is not a feature"),
        ({"complete": True, "n_terms": 1000, "spacing": "uniform"}, "1e\\+06 combinations"),
        ({"min_support": 1000}, "min_support=1000"),
    ],
)
def test_settings_that_cannot_be_used(wave, settings, message):
    with pytest.raises(ValueError, match=message):
        FuzzyRegressor(**settings).fit(*wave)


def test_one_class_is_refused():
    with pytest.raises(ValueError, match="1 class"):
        FuzzyRiskClassifier().fit([[0.0], [1.0]], [1, 1])


def test_many_classes_have_a_rule_set_each():
    X, y = load_iris(return_X_y=True)
    names = np.array(["setosa", "versicolor", "virginica"])[y]
    scores = cross_val_score(FuzzyClassifier(), X[:, 2:], names, cv=5)
    assert scores.mean() > 0.93, scores
    classifier = FuzzyClassifier().fit(X[:, 2:], names)
    assert len(classifier.rule_sets_) == 3
    assert classifier.n_rules_ == sum(len(rule_set.rules) for rule_set in classifier.rule_sets_)
    probabilities = classifier.predict_proba(X[:, 2:])
    assert np.allclose(probabilities.sum(axis=1), 1)
    explained = classifier.explain(X[:2, 2:])
    degrees = np.array([[one.outputs[0].value for one in row] for row in explained])
    assert np.allclose(degrees / degrees.sum(axis=1, keepdims=True), probabilities[:2])
    with pytest.raises(ValueError, match="two classes"):
        FuzzyClassifier(monotonic_cst=[1, 0]).fit(X[:, 2:], names)



def test_intervals_contain_the_promised_share_of_new_rows():
    random = np.random.default_rng(4)
    X = random.uniform(0, 6, (3000, 2))
    y = np.sin(X[:, 0]) + 0.5 * X[:, 1] + random.normal(0, 0.3, 3000)
    regressor = ConformalRegressor(random_state=0).fit(X[:1500], y[:1500])
    widths = []
    for coverage in (0.5, 0.8, 0.95):
        low, high = regressor.predict_interval(X[1500:], coverage).T
        share = np.mean((low <= y[1500:]) & (y[1500:] <= high))
        # 375 errors and 1500 rows: the share varies by about 0.03 (one standard deviation at 0.5).
        assert abs(share - coverage) < 0.08, (coverage, share)
        widths.append(high[0] - low[0])
    assert widths == sorted(widths)
    assert widths[2] < 4 * 0.3 * 1.5
    assert np.all(regressor.predict_interval(X[:9]).mean(axis=1).round(9) == regressor.predict(X[:9]).round(9))


def test_intervals_by_hand():
    class Zero(FuzzyRegressor):
        def fit(self, X, y, sample_weight=None):
            return self

        def predict(self, X):
            return np.zeros(len(X))

    X, y = np.arange(40.0)[:, None], np.arange(40.0)
    regressor = ConformalRegressor(Zero(), calibration_size=9 / 40, random_state=1).fit(X, y)
    # With 9 errors, the half width at 50 % is the 5th: ceil(10 * 0.5) = 5; 90 % uses all 9.
    assert len(regressor.errors_) == 9
    assert regressor.predict_interval([[3]], 0.5).tolist() == [[-regressor.errors_[4], regressor.errors_[4]]]
    assert regressor.predict_interval([[3]], 0.9)[0, 1] == regressor.errors_[8]
    with pytest.raises(ValueError, match="intervals of 95% need 19 calibration rows, and there are 9"):
        regressor.predict_interval([[3]], 0.95)


def test_groups_are_on_one_side_of_the_calibration():
    random = np.random.default_rng(5)
    X = random.uniform(0, 1, (200, 1))
    vehicle = np.repeat(np.arange(10), 20)
    # Each vehicle has its own offset: errors on known vehicles are smaller than those on others.
    y = X[:, 0] + vehicle
    with_vehicle = np.column_stack((X, vehicle))
    plain = ConformalRegressor(FuzzyRegressor(n_terms=7), random_state=0).fit(with_vehicle, y)
    grouped = ConformalRegressor(FuzzyRegressor(n_terms=7), random_state=0).fit(with_vehicle, y, groups=vehicle)
    assert len(grouped.errors_) in (40, 60)
    assert grouped.errors_.max() > plain.errors_.max()

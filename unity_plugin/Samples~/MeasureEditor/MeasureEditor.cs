using UnityEngine;

namespace Anthronet.Samples
{
    /// <summary>An in-game panel with a toggle and a slider for every measure, which change the character at
    /// once.</summary>
    public sealed class MeasureEditor : MonoBehaviour
    {
        /// <summary>Measures without a side come first, then those of the left, which stand for both sides
        /// here.</summary>
        const int Shown = 24;

        [Tooltip("Sex of the person.")]
        public AnthroSex sex = AnthroSex.Female;

        readonly AnthroMeasureReport[] reports = new AnthroMeasureReport[AnthroMeasures.Count];
        AnthroCharacter character;
        AnthroRequest request;
        string error = "";
        Vector2 scroll;

        void Start()
        {
            request = new AnthroRequest { Sex = sex };
            character = AnthroFactory.Create(request, new AnthroSettings { finestLod = 0, parent = transform });
            character.gameObject.AddComponent<AnthroAnimator>().Play("idle");
            character.Body.Measures(reports);
        }

        void OnGUI()
        {
            GUILayout.BeginArea(new Rect(10, 10, 420, Screen.height - 20));
            scroll = GUILayout.BeginScrollView(scroll);
            var changed = false;
            for (var measure = 0; measure < Shown; measure++)
            {
                changed |= Row(measure);
            }
            if (GUILayout.Button("Another person"))
            {
                request.Seed++;
                request.Fill = AnthroFill.Sample;
                changed = true;
            }
            GUILayout.Label(error);
            GUILayout.EndScrollView();
            GUILayout.EndArea();
            if (changed)
            {
                Apply();
            }
        }

        /// <summary>Draws the row of a measure: whether it is set, and its value.</summary>
        /// <returns>Whether the user changed it.</returns>
        bool Row(int measure)
        {
            double min, max;
            AnthroModel.Default.MeasureRange(measure, out min, out max);
            var name = AnthroMeasures.Names[measure].Replace("_left", "");
            var was = request.IsGiven(measure);
            var value = (float)(was ? request[measure] : reports[measure].obtained);
            GUILayout.BeginHorizontal();
            var given = GUILayout.Toggle(was, name.Replace('_', ' '), GUILayout.Width(190));
            var moved = GUILayout.HorizontalSlider(value, (float)min, (float)max);
            GUILayout.Label(value.ToString("0.000") + " m", GUILayout.Width(70));
            GUILayout.EndHorizontal();
            if (moved != value)
            {
                request.Set(name, moved);
                return true;
            }
            if (given == was)
            {
                return false;
            }
            if (given)
            {
                request.Set(name, reports[measure].obtained);
            }
            else
            {
                request.Unset(name);
            }
            return true;
        }

        void Apply()
        {
            character.Request = request;
            try
            {
                character.Generate();
                character.Body.Measures(reports);
                error = "";
            }
            catch (AnthroException refused)
            {
                // The character is unchanged.
                error = refused.Message;
            }
        }
    }
}

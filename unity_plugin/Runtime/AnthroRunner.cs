using System;
using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// Advances spawns each frame within a budget of time, and in the editor's edit mode each time that the editor looks
    /// for work. Ends with the play mode.
    /// </summary>
    [AddComponentMenu("")]
    public sealed class AnthroRunner : MonoBehaviour
    {
        const double DefaultBudget = 4.0;

        static readonly List<AnthroSpawn> spawns = new List<AnthroSpawn>();
        static AnthroRunner runner;

        /// <summary>Milliseconds of each frame for all spawns together.</summary>
        public static double Budget = DefaultBudget;

        /// <summary>Number of spawns that are not done.</summary>
        public static int Count
        {
            get { return spawns.Count; }
        }

        /// <summary>Advances a spawn each frame until it is done, then frees it.</summary>
        /// <returns>The spawn.</returns>
        public static AnthroSpawn Run(AnthroSpawn spawn)
        {
            Native.Library.NotNull(spawn, "spawn");
            spawns.Add(spawn);
            if (Application.isPlaying)
            {
                if (runner == null)
                {
                    var home = new GameObject("AnthroNet Runner");
                    // Not `DontSave`: with that it would outlive the play mode.
                    home.hideFlags = HideFlags.HideInHierarchy;
                    DontDestroyOnLoad(home);
                    runner = home.AddComponent<AnthroRunner>();
                }
                return spawn;
            }
#if UNITY_EDITOR
            UnityEditor.EditorApplication.update -= Tick;
            UnityEditor.EditorApplication.update += Tick;
#endif
            return spawn;
        }

        void Update()
        {
            Tick();
        }

        /// <summary>Goes on with all spawns. One that throws is told and given up; the others go on.</summary>
        static void Tick()
        {
            for (var i = spawns.Count - 1; i >= 0; i--)
            {
                var spawn = spawns[i];
                var done = true;
                try
                {
                    done = spawn.Advance(Budget / spawns.Count);
                }
                catch (Exception error)
                {
                    Debug.LogException(error);
                }
                if (done)
                {
                    spawns.Remove(spawn);
                    spawn.Dispose();
                }
            }
#if UNITY_EDITOR
            if (spawns.Count == 0)
            {
                UnityEditor.EditorApplication.update -= Tick;
            }
#endif
        }

        void OnDestroy()
        {
            ReleaseAll();
        }

        /// <summary>Frees all spawns.</summary>
        internal static void ReleaseAll()
        {
            foreach (var spawn in spawns)
            {
                spawn.Dispose();
            }
            spawns.Clear();
        }

        // Without a reload of the domain, statics of the last play are still there.
        [RuntimeInitializeOnLoadMethod(RuntimeInitializeLoadType.SubsystemRegistration)]
        static void Restart()
        {
            ReleaseAll();
            runner = null;
            Budget = DefaultBudget;
        }
    }
}

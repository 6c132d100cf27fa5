using System.Collections.Generic;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>What characters that the factory makes are like.</summary>
    public sealed class AnthroSettings
    {
        /// <summary>The finest level of detail, 0 to 3.</summary>
        public int finestLod = 1;
        /// <summary>The coarsest level of detail, 0 to 3.</summary>
        public int coarsestLod = 3;
        /// <summary>Step of the Monk scale, 1 to 10; 0 for the default.</summary>
        public int skinTone;
        /// <summary>Whether they are without eyes, teeth, tongue and lashes.</summary>
        public bool bodyOnly;
        /// <summary>Whether they get a humanoid avatar.</summary>
        public bool humanoid = true;
        /// <summary>Where they go; null for the scene's root.</summary>
        public Transform parent;
        /// <summary>The model that makes them; null for the library's own.</summary>
        public AnthroModel model;
        /// <summary>Where characters are taken from: levels of detail are those that they have; null for none.</summary>
        public AnthroPool pool;

        internal AnthroSettings Copy()
        {
            return (AnthroSettings)MemberwiseClone();
        }
    }

    /// <summary>Makes characters from code.</summary>
    public static class AnthroFactory
    {
        /// <summary>Makes a character, at once. On the main thread.</summary>
        /// <exception cref="AnthroException">The request is refused; the scene stays as it was.</exception>
        public static AnthroCharacter Create(AnthroRequest request, AnthroSettings settings = null)
        {
            settings = settings ?? new AnthroSettings();
            var body = (settings.model ?? AnthroModel.Default).Generate(request);
            var character = Asleep(request, settings);
            try
            {
                character.Become(body);
            }
            catch
            {
                character.Release();
                AnthroObjects.Discard(character.gameObject);
                throw;
            }
            character.gameObject.SetActive(true);
            return character;
        }

        /// <summary>
        /// Makes characters: bodies and all that their meshes hold on threads, then the objects on the main thread in slices.
        /// Something has to call `AnthroSpawn.Advance` each frame: `AnthroRunner.Run` does.
        /// </summary>
        public static AnthroSpawn CreateAsync(IList<AnthroRequest> requests, AnthroSettings settings = null)
        {
            var copies = new AnthroRequest[Library.NotNull(requests, "requests").Count];
            for (var i = 0; i < copies.Length; i++)
            {
                copies[i] = Library.NotNull(requests[i], "requests").Copy();
            }
            return new AnthroSpawn(copies, settings == null ? new AnthroSettings() : settings.Copy());
        }

        /// <summary>A character that sleeps, so that nobody sees it before it is whole: of the pool, or one with nothing.
        /// </summary>
        internal static AnthroCharacter Asleep(AnthroRequest request, AnthroSettings settings)
        {
            var character = settings.pool == null ? null : settings.pool.Take();
            if (character == null)
            {
                var made = new GameObject("AnthroNet Character");
                made.SetActive(false);
                character = made.AddComponent<AnthroCharacter>();
                character.GenerateOnAwake = false;
                character.FinestLod = settings.finestLod;
                character.CoarsestLod = settings.coarsestLod;
            }
            character.transform.SetParent(settings.parent, false);
            character.Request = request.Copy();
            character.SkinTone = settings.skinTone;
            character.BodyOnly = settings.bodyOnly;
            character.Humanoid = settings.humanoid;
            return character;
        }
    }
}
